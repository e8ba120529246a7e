"""A recording with pictures is an origin of cameras, as a capture folder is."""

import logging
from pathlib import Path

import cv2
import numpy as np
import pytest

from mocapd.boundary.image_decoding import decode_picture
from mocapd.capture.capture_folder import frame_sets, load_folder
from mocapd.capture.frame_groups import as_set
from mocapd.capture.kinds.folder_kind import FolderOrigin
from mocapd.capture.kinds.source_kinds import cameras_of_origin, open_origin, open_source, origin_of
from mocapd.capture.pace import Pace
from mocapd.capture.recording.recording_metadata import RecordingMetadata
from mocapd.capture.source_request import SourceRequest
from mocapd.clock import monotonic_ns
from mocapd.errors import ConfigError, EndOfStream, InputError
from mocapd.outputs.mcap.recording_writer import RecordingParams, RecordingWriter
from mocapd.types import FrameSet, LabelledPicture, Rig
from tests.capture.films import number_of, write_capture
from tests.capture.recorded_pictures import START_NS, recorded_capture
from tests.geometry.rigs import ring


def quiet(_what: str, _done: int, _total: int) -> None:
    """Nobody looks."""


def sets_of(origin: str) -> list[FrameSet]:
    return list(open_origin(origin, Path(), quiet).frame_sets())


def test_it_knows_what_its_capture_knew(tmp_path: Path) -> None:
    folder = FolderOrigin(load_folder(write_capture(tmp_path / "capture")))
    origin = open_origin(str(recorded_capture(tmp_path)), Path(), quiet)
    assert origin.stature_m == 1.72
    assert origin.count == 12
    assert origin.fps_hz == pytest.approx(folder.fps_hz, rel=1e-3)
    for ours, theirs in zip(origin.rig.cameras, folder.rig.cameras, strict=True):
        assert ours.name == theirs.name
        assert np.array_equal(ours.K, theirs.K)
        assert np.array_equal(ours.R, theirs.R)
    (picture,) = origin.model()
    assert picture.labels.max() == 3
    assert set(origin.white_balance()) == {"cam1"}


def test_every_picture_comes_back_with_its_time_and_its_jpeg(tmp_path: Path) -> None:
    recorded = sets_of(str(recorded_capture(tmp_path)))
    played = list(frame_sets(load_folder(tmp_path / "capture")))
    assert len(recorded) == len(played)
    for ours, theirs in zip(recorded, played, strict=True):
        assert list(ours.frames) == ["cam0", "cam1"]
        assert ours.t_ns == theirs.t_ns
        for name, frame in ours.frames.items():
            assert frame.t_ns == theirs.frames[name].t_ns
            assert number_of(frame.pixels) == number_of(theirs.frames[name].pixels)
            assert frame.encoded is not None
            decoded = decode_picture(frame.encoded, cv2.IMREAD_COLOR)
            assert np.array_equal(decoded, frame.pixels)


def test_a_camera_that_missed_a_frame_is_absent_from_its_set(tmp_path: Path) -> None:
    path = recorded_capture(tmp_path, missing=("cam1", 4))
    sets = sets_of(str(path))
    assert [list(one.frames) for one in sets[3:6]] == [["cam0", "cam1"], ["cam0"], ["cam0", "cam1"]]
    assert as_set(dict(sets[4].frames)).t_ns == sets[4].t_ns


def test_one_camera_by_its_address(tmp_path: Path) -> None:
    path = recorded_capture(tmp_path)
    assert origin_of(f"{path}#cam1") == str(path)
    assert cameras_of_origin(str(path)) == ("cam0", "cam1")
    source = open_source(f"{path}#cam1", SourceRequest("left"))
    assert source.recorded
    source.open()
    frames = [source.read() for _ in range(12)]
    assert [number_of(frame.pixels) for frame in frames] == list(range(12))
    assert {frame.camera for frame in frames} == {"left"}
    with pytest.raises(EndOfStream):
        source.read()
    with pytest.raises(ConfigError, match="say which"):
        open_source(str(path))
    with pytest.raises(ConfigError, match="no camera 'cam7'"):
        open_source(f"{path}#cam7")
    with pytest.raises(ConfigError, match="calibrated at"):
        open_source(f"{path}#cam0", SourceRequest(size_px=(640, 480)))


def test_live_it_plays_on_the_clock(tmp_path: Path) -> None:
    source = open_source(f"{recorded_capture(tmp_path)}#cam0", SourceRequest(pace=Pace(live=True)))
    source.open()
    began_ns = monotonic_ns()
    times = [source.read().t_ns for _ in range(3)]
    assert all(began_ns <= t_ns <= monotonic_ns() for t_ns in times)
    assert times[2] - times[0] >= 60_000_000


def test_a_truncated_recording_plays_to_where_it_is_cut(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = recorded_capture(tmp_path)
    data = path.read_bytes()
    path.write_bytes(data[: data.index(b"zstd", data.index(b"zstd") + 4) + 300])  # the second chunk
    with caplog.at_level(logging.WARNING):
        sets = sets_of(str(path))
    assert 0 < len(sets) < 12
    assert "cut short" in caplog.text


def test_a_damaged_picture_is_left_out(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING):
        sets = sets_of(str(recorded_capture(tmp_path, torn=("cam0", 2))))
    assert list(sets[2].frames) == ["cam1"]
    assert "'cam0' is left out" in caplog.text


def test_what_is_missing_in_it_is_named(tmp_path: Path) -> None:
    with RecordingWriter(tmp_path / "a.mcap", RecordingParams(), 0) as writer:
        writer.picture("cam0", 0, START_NS, b"")
    with pytest.raises(InputError, match="where its cameras stood"):
        sets_of(str(tmp_path / "a.mcap"))
    with RecordingWriter(tmp_path / "b.mcap", RecordingParams(), 0) as writer:
        writer.attach(RecordingMetadata(), START_NS)
    with pytest.raises(InputError, match="no pictures"):
        sets_of(str(tmp_path / "b.mcap"))
    with pytest.raises(InputError, match="no such"):
        sets_of(str(tmp_path / "none.mcap"))


def test_a_camera_that_its_rig_does_not_know_is_named(tmp_path: Path) -> None:
    """Else its pictures would be passed over in silence, and a person be tracked by fewer cameras than were recorded."""
    rig = Rig(ring(2))
    with RecordingWriter(tmp_path / "a.mcap", RecordingParams(), 0) as writer:
        writer.attach(RecordingMetadata(rig), START_NS)
        for name in (*rig.names, "stranger"):
            writer.picture(name, 0, START_NS, b"")
    with pytest.raises(InputError, match="no camera 'stranger'"):
        sets_of(str(tmp_path / "a.mcap"))


def test_no_address_of_a_camera_is_in_it(tmp_path: Path) -> None:
    """Rig and pictures only: the fields of a rig file have no place for one."""
    from mocapd.capture.recording.recording_metadata import attachments_of

    label = LabelledPicture(np.zeros((4, 4, 3), np.uint8), np.zeros((4, 4), np.uint8))
    known = RecordingMetadata(Rig(ring(2)), 1.8, (label,), {"cam0": label})
    names = [one.name for one in attachments_of(known)]
    assert names == [
        "rig.json",
        "wearer.json",
        "white_balance/cam0.png",
        "white_balance/cam0_strokes.png",
        "model/0.png",
        "model/0_strokes.png",
    ]
