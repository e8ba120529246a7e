"""Every picture of every camera for a recorder, as its camera delivered it."""

import time
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed

from mocapd.app.daemon.daemon_pictures import DaemonPictures, RecordingHeader
from mocapd.capture.kinds.source_kinds import open_origin
from mocapd.config.web_params import Params
from mocapd.errors import UnavailableError
from mocapd.outputs.mcap.recording_writer import RecordingParams, RecordingWriter
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.types import Frame
from mocapd.web.runtime_file import Place
from mocapd.web.server import WebServer
from tests.outputs.frames import eventually
from tests.web.browser import connect, until_closed
from tests.web.tiny_host import TinyHost


@pytest.fixture
def folder(tmp_path: Path, host: TinyHost) -> Iterator[Path]:
    """Where the page of `host` is announced, as daemon `pc`."""
    place = Place(tmp_path / "run", tmp_path, "pc")
    died: list[BaseException] = []
    with WebServer(host, Params(), died.append, place):
        yield place.folder
    assert died == []


def jpeg_of(value: int) -> bytes:
    return cv2.imencode(".jpg", np.full((480, 640, 3), value, np.uint8))[1].tobytes()


def record_shown(
    folder: Path, host: TinyHost, path: Path, shown: list[tuple[str, bytes | None]]
) -> list[Frame]:
    """The frames that were shown while a recorder was there, and are in the file."""
    frames = []
    with (
        DaemonPictures(folder, "pc") as pictures,
        RecordingWriter(path, RecordingParams(private=True), 0) as writer,
    ):
        pictures.drain(writer, 0)
        assert eventually(lambda: hub_is_joined(host))
        for number, (camera, encoded) in enumerate(shown):
            frames.append(host.show(camera, number, encoded=encoded))

        def all_there() -> bool:
            pictures.drain(writer, time.time_ns())
            return writer.pictures == len(shown)

        assert eventually(all_there)
        assert pictures.dropped == 0
    return frames


def hub_is_joined(host: TinyHost) -> bool:
    assert host.hub is not None
    return bool(host.hub._onwards)


def test_what_was_delivered_is_in_the_file_bit_by_bit(
    folder: Path, host: TinyHost, tmp_path: Path
) -> None:
    jpegs = [jpeg_of(value) for value in (40, 90, 140, 190)]
    shown = [(f"cam{i % 2}", jpeg) for i, jpeg in enumerate(jpegs)]
    path = tmp_path / "a.mcap"
    frames = record_shown(folder, host, path, list(shown))
    origin = open_origin(str(path), tmp_path, lambda *_: None)
    assert host.rig is not None
    assert origin.rig.names == host.rig.names
    assert origin.stature_m == 1.75
    read = [frame for one in origin.frame_sets() for frame in one.frames.values()]
    assert sorted(frame.encoded or b"" for frame in read) == sorted(jpegs)
    first_ns = min(frame.t_ns for frame in frames)
    for frame in read:
        assert abs(frame.t_ns - (frames[frame.seq].t_ns - first_ns)) < 1_000_000


def test_a_camera_without_jpeg_is_encoded_once(
    folder: Path, host: TinyHost, tmp_path: Path
) -> None:
    record_shown(folder, host, tmp_path / "a.mcap", [("cam0", None), ("cam1", jpeg_of(7))])
    origin = open_origin(str(tmp_path / "a.mcap"), tmp_path, lambda *_: None)
    frames = [one for each in origin.frame_sets() for one in each.frames.values()]
    assert [
        abs(int(frame.pixels.mean()) - value) < 3
        for frame, value in zip(frames, (0, 7), strict=True)
    ] == [True, True]


def test_another_sessions_cameras_are_recorded_on(
    folder: Path, host: TinyHost, tmp_path: Path
) -> None:
    with (
        DaemonPictures(folder, "pc") as pictures,
        RecordingWriter(tmp_path / "a.mcap", RecordingParams(), 0) as writer,
    ):
        assert eventually(lambda: hub_is_joined(host))
        before = host.hub
        host.hub = FrameHub(("cam0", "cam1"))
        assert eventually(lambda: hub_is_joined(host))
        assert before is not None
        assert not before._onwards
        host.show("cam1", 5, encoded=jpeg_of(9))

        def one_there() -> bool:
            pictures.drain(writer, 0)
            return writer.pictures == 1

        assert eventually(one_there)


def test_a_disk_slower_than_the_cameras_does_not_hold_the_recorder(tmp_path: Path) -> None:
    """Else it would look neither at its end nor at Ctrl-C."""
    pictures = DaemonPictures(tmp_path, "pc")
    one = RecordingHeader(camera="cam0"), b""

    class SlowDisk(RecordingWriter):
        def picture(self, camera: str, seq: int, unix_ns: int, jpeg: bytes) -> None:
            self.pictures += 1
            if self.pictures < 100:
                pictures._waiting.put(one)  # the next one comes meanwhile

    with SlowDisk(tmp_path / "a.mcap", RecordingParams(), 0) as writer:
        for _ in range(3):
            pictures._waiting.put(one)
        pictures.drain(writer, 0)
        assert writer.pictures == 3


def test_a_daemon_without_page_is_named(folder: Path) -> None:
    with pytest.raises(UnavailableError, match="no page of daemon 'other'"):
        DaemonPictures(folder, "other").__enter__()


def test_whoever_says_something_is_sent_away(server: WebServer) -> None:
    with connect(server, "/recording") as socket:
        socket.send("{}")
        with pytest.raises(ConnectionClosed, match="nothing is to be said"):
            until_closed(socket)


def test_nobody_looks_when_the_recorder_has_left(folder: Path, host: TinyHost) -> None:
    with DaemonPictures(folder, "pc"):
        assert eventually(lambda: hub_is_joined(host))
    assert eventually(lambda: not hub_is_joined(host))
