"""Recordings of one camera for load: a few pictures over and over, as large as a webcam's."""

from pathlib import Path

import cv2
import numpy as np

from mocapd.capture.recording.recording_metadata import RecordingMetadata
from mocapd.clock import NS_PER_S
from mocapd.geometry.nominal_rig import nominal_rig
from mocapd.outputs.mcap.recording_writer import RecordingParams, RecordingWriter

CAMERA = "cam0"
_PICTURES = 16
_START_NS = 1_700_000_000_000_000_000


def jpegs(size_px: tuple[int, int]) -> list[bytes]:
    """Pictures with as much texture as a furnished room: some 45 kB at 640x480."""
    width, height = size_px
    random = np.random.default_rng(1)
    found = []
    for i in range(_PICTURES):
        small = random.integers(0, 255, (height // 12, width // 12, 3), dtype=np.uint8)
        picture = cv2.resize(small, size_px, interpolation=cv2.INTER_CUBIC).astype(np.int16)
        noisy = picture + random.integers(-5, 6, picture.shape)
        ready = np.clip(noisy, 0, 255).astype(np.uint8)
        cv2.circle(ready, (20 + i, height // 2), 8, (255, 255, 255), -1)
        found.append(cv2.imencode(".jpg", ready, [cv2.IMWRITE_JPEG_QUALITY, 80])[1].tobytes())
    return found


def write_recording(
    path: Path, size_px: tuple[int, int], rate_hz: float, duration_s: float
) -> Path:
    """So long [s] of one camera at this rate."""
    files = jpegs(size_px)
    known = RecordingMetadata(nominal_rig(CAMERA, size_px), 1.75, (), {})
    with RecordingWriter(path, RecordingParams(), _START_NS) as writer:
        writer.attach(known, _START_NS)
        for n in range(round(duration_s * rate_hz)):
            t_ns = _START_NS + round(n / rate_hz * NS_PER_S)
            writer.picture(CAMERA, n, t_ns, files[n % len(files)])
            if n % 16 == 15:
                writer.flush_if_due(t_ns)
    return path
