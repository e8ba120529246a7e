"""The recorder behind the page's button: what it holds while the disk is slow."""

import gc
import threading
import time
import weakref
from pathlib import Path
from types import SimpleNamespace

import pytest

from mocapd.body.shape import mean_shape, skeleton_of
from mocapd.capture.recording.recording_metadata import RecordingMetadata
from mocapd.errors import CannotCreateError
from mocapd.outputs.mcap.recording_writer import RecordingWriter
from mocapd.pipeline.body_hub import BodyHub, BodySample
from mocapd.service import body_recorder
from mocapd.service.body_recorder import BodyRecorder
from mocapd.service.recordings_folder import Recordings
from mocapd.tracking.base import Track, lost_body
from mocapd.types import Frame, FrameSet
from tests.outputs.frames import eventually
from tests.pipeline.free_running import PIXELS


def test_what_a_full_disk_has_cut_off_is_told_at_the_end_and_its_length_is_that_of_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise CannotCreateError("cannot be written any further", "it", "make room")

    def begin(path: Path) -> BodyRecorder:
        return BodyRecorder(BodyHub(), path, RecordingMetadata(), "pc")

    now_s = 100.0
    clock = SimpleNamespace(time_ns=time.time_ns, monotonic=lambda: now_s)
    monkeypatch.setattr(body_recorder, "time", clock)
    monkeypatch.setattr(RecordingWriter, "attach", full)
    recordings = Recordings(tmp_path, begin)
    recordings.start()
    assert eventually(lambda: (now := recordings.list().now) is not None and now.trouble != "")
    now_s = 3700.0
    with pytest.raises(CannotCreateError, match="any further"):
        recordings.stop()
    (one,) = recordings.list().recordings
    assert one.length_s == 0.0


def test_frames_that_a_slow_disk_loses_are_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    goes_on = threading.Event()
    monkeypatch.setattr(RecordingWriter, "attach", lambda *_: goes_on.wait())
    monkeypatch.setattr(body_recorder, "_MOST_WAITING", 2)
    bodies, shape = BodyHub(), mean_shape(1.7)

    def begin(path: Path) -> BodyRecorder:
        return BodyRecorder(bodies, path, RecordingMetadata(), "pc")

    recordings = Recordings(tmp_path, begin)
    recordings.start()
    for k in range(5):
        track = Track(lost_body(k, "canned"), shape)
        bodies.put(BodySample(track, skeleton_of(shape), FrameSet(k, {})))
    now = recordings.list().now
    goes_on.set()
    recordings.stop()
    assert now is not None
    assert now.trouble == "3 frames are lost: the disk is too slow"


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
