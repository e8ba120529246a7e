"""The recorder behind the page's button: what it holds while the disk is slow."""

import gc
import weakref
from pathlib import Path

import pytest

from mocapd.body.shape import mean_shape, skeleton_of
from mocapd.capture.recording.recording_metadata import RecordingMetadata
from mocapd.errors import CannotCreateError
from mocapd.outputs.mcap.recording_writer import RecordingWriter
from mocapd.pipeline.body_hub import BodyHub, BodySample
from mocapd.service.body_recorder import BodyRecorder
from mocapd.tracking.base import Track, lost_body
from mocapd.types import Frame, FrameSet
from tests.pipeline.free_running import PIXELS


def test_a_full_disk_holds_no_pictures_in_memory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Six hundred bodies may wait, and with all of their pictures these would be gigabytes."""

    def full(*_: object) -> None:
        raise CannotCreateError("cannot be written any further", "it", "make room")

    monkeypatch.setattr(RecordingWriter, "frame", full)
    bodies, shape = BodyHub(), mean_shape(1.7)
    with BodyRecorder(bodies, tmp_path / "a.mcap", RecordingMetadata(), "pc"):
        pixels = PIXELS.copy()
        held = weakref.ref(pixels)
        for k in range(3):
            frames = FrameSet(k, {"a": Frame("a", k, k, pixels)})
            track = Track(lost_body(k, "canned"), shape)
            bodies.put(BodySample(track, skeleton_of(shape), frames))
        bodies.forget()
        del pixels, frames
        gc.collect()
        assert held() is None
