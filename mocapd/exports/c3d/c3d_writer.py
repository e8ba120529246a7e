"""Motion as C3D: joints as points.

Millimetres; axes as in mocapd, which POINT:X_SCREEN (+X) and POINT:Y_SCREEN (+Y, or +Z with z up) name. A point in a gap
is invalid: it has the format's residual of -1.

The header and POINT:FRAMES count frames in 16 bits. A longer motion has 65535 there. Its true count is in the places
that programs read next: POINT:LONG_FRAMES as a float, TRIAL:ACTUAL_END_FIELD as two 16-bit words, and the length of the
file, which therefore ends with the last frame. (ezc3d refuses POINT:FRAMES as a float, which the manual allows.)
"""

import struct
from pathlib import Path

import numpy as np

from mocapd.exports.c3d.c3d_parameters import (
    BLOCK,
    Groups,
    pack_parameters,
    read_parameters,
    split_rows,
)
from mocapd.exports.sampled_motion import SampledMotion

MM = 1000.0
MOST_FRAMES = 2**24  # a 32-bit float counts them one by one
_WORD = 0xFFFF
_HEADER = "<BBHHHHHfHHf"
_FOUR_CHARACTERS = 12345  # in word 150: names of events have four characters; there are none
_FRAMES_AT_ONCE = 10_000  # in memory as floats of the file


def write_c3d(motion: SampledMotion, path: Path) -> None:
    """Write the file. Raises OSError. Names of joints are ASCII, of 255 bytes at most."""
    frames, points = motion.joints_m.shape[:2]
    parameters = pack_parameters(_groups(motion, 0))
    data_block = 2 + len(parameters) // BLOCK  # counted from 1
    parameters = pack_parameters(_groups(motion, data_block))
    header = struct.pack(
        _HEADER,
        *(2, 0x50, points, 0, 1, min(frames, _WORD), 0, -1.0, data_block, 0, motion.rate_hz),
    )
    header = header.ljust(2 * 149, b"\0") + struct.pack("<H", _FOUR_CHARACTERS)
    with path.open("wb") as file:
        file.write(header.ljust(BLOCK, b"\0") + parameters)
        for first in range(0, frames, _FRAMES_AT_ONCE):
            part = slice(first, first + _FRAMES_AT_ONCE)
            rows = np.zeros((*motion.joints_m[part].shape[:2], 4), "<f4")
            missing = motion.gap[part].astype(bool)
            rows[..., :3] = np.where(missing[:, None, None], 0.0, motion.joints_m[part] * MM)
            rows[missing, :, 3] = -1.0
            file.write(rows.tobytes())
        if frames < _WORD:
            file.write(b"\0" * (-file.tell() % BLOCK))


def frames_in_c3d(path: Path) -> int:
    """The number of frames in a file of ours: as its parameters say, or fewer where it is truncated."""
    with path.open("rb") as file:
        header = struct.unpack_from(_HEADER, file.read(BLOCK))
        points, data_block = int(header[2]), int(header[8])
        file.seek(BLOCK)
        section = file.read((data_block - 2) * BLOCK)
        bytes_there = file.seek(0, 2) - (data_block - 1) * BLOCK
    numbers = {entry.name: entry.numbers for entry in read_parameters(section) if entry.kind > 0}
    (count,) = numbers.get("LONG_FRAMES", numbers["FRAMES"])
    return min(int(count), bytes_there // (16 * points))


def _groups(motion: SampledMotion, data_block: int) -> Groups:
    frames, points = motion.joints_m.shape[:2]
    words = np.array([frames & _WORD, frames >> 16])
    is_long = frames >= _WORD
    return {
        "POINT": {
            "USED": np.array([points]),
            "FRAMES": np.array([min(frames, _WORD)]),
            **({"LONG_FRAMES": np.array([float(frames)])} if is_long else {}),
            "SCALE": np.array([-1.0]),
            "RATE": np.array([motion.rate_hz]),
            "DATA_START": np.array([data_block]),
            "UNITS": ["mm"],
            "X_SCREEN": ["+X"],
            "Y_SCREEN": [f"+{motion.up.upper()}"],
            **split_rows("LABELS", motion.skeleton.names),
            **split_rows("DESCRIPTIONS", motion.skeleton.names),
        },
        "ANALOG": {
            "USED": np.array([0]),
            "RATE": np.array([0.0]),
            "GEN_SCALE": np.array([1.0]),
            "SCALE": np.zeros(0),
            "OFFSET": np.zeros(0, dtype=int),
            "LABELS": [],
            "DESCRIPTIONS": [],
            "UNITS": [],
        },
        "TRIAL": {"ACTUAL_START_FIELD": np.array([1, 0]), "ACTUAL_END_FIELD": words},
    }
