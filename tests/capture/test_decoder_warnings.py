"""A camera whose pictures are damaged does not fill the log; whatever else writes to stderr still does."""

import os
import subprocess
import sys

from tests.attacks.node_kinds import KINDS

PICTURES = 300
PROGRAM = """
import logging, os, sys
from mocapd.boundary.image_decoding import decode_camera_picture
from mocapd.capture.decoder_warnings import DecoderWarnings

logging.basicConfig(format="%(message)s")
data = sys.stdin.buffer.read()
with DecoderWarnings():
    for _ in range(int(sys.argv[1])):
        decode_camera_picture(data)
    os.write(2, b"by number\\n")
    print("by Python", file=sys.stderr)
decode_camera_picture(data)
"""


def test_a_flood_of_damaged_pictures_is_a_few_lines_and_the_rest_of_stderr_stays() -> None:
    ran = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(PICTURES)],
        input=KINDS["jpeg-damaged"].picture(0),
        capture_output=True,
        check=True,
        env=os.environ,
    )
    lines = ran.stderr.decode().splitlines()
    assert "by number" in lines
    assert "by Python" in lines
    assert lines[-1].startswith("Corrupt JPEG data")  # after the end, as before
    told = [line for line in lines if "a picture of a camera is damaged: Corrupt JPEG" in line]
    assert 1 <= len(told) <= PICTURES / 10
    assert len(lines) == len(told) + 3
