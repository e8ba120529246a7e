"""A small capture folder as a recording: the same pictures at the same times."""

from pathlib import Path

import cv2
import numpy as np

from mocapd.capture.capture_folder import frame_sets, load_folder
from mocapd.capture.recording.recording_metadata import RecordingMetadata
from mocapd.outputs.mcap.recording_writer import RecordingParams, RecordingWriter
from mocapd.types import LabelledPicture
from tests.capture.films import write_capture

START_NS = 1_700_000_000_000_000_000


def recorded_capture(
    folder: Path,
    missing: tuple[str, int] | None = None,
    torn: tuple[str, int] | None = None,
) -> Path:
    """The recording of `folder`/capture, which is written if need be; without one camera's picture of a number, or
    with it torn."""
    capture = folder / "capture"
    if not capture.exists():
        write_capture(capture)
    loaded = load_folder(capture)
    strokes = np.zeros((48, 64), np.uint8)
    strokes[5:9, 5:9] = 3
    labelled = LabelledPicture(np.full((48, 64, 3), 99, np.uint8), strokes)
    known = RecordingMetadata(loaded.rig, 1.72, (labelled,), {"cam1": labelled})
    path = folder / "recorded.mcap"
    with RecordingWriter(path, RecordingParams(), START_NS) as writer:
        writer.attach(known, START_NS)
        for one in frame_sets(loaded):
            for name, frame in one.frames.items():
                if (name, frame.seq) == missing:
                    continue
                jpeg = cv2.imencode(".jpg", frame.pixels)[1].tobytes()
                if (name, frame.seq) == torn:
                    jpeg = jpeg[:60]
                writer.picture(name, frame.seq, START_NS + frame.t_ns, jpeg)
                if frame.seq % 4 == 3:
                    writer.flush_if_due(START_NS + 10**9 * frame.seq)
    return path
