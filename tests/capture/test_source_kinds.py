"""What the camera strings of a configuration mean."""

from pathlib import Path

import pytest

from mocapd.capture.file import FileSource
from mocapd.capture.kinds.source_kinds import (
    SOURCE_FORMS,
    address_in_folder,
    cameras_of_origin,
    identities_of,
    is_settable,
    is_simulated,
    kind_of,
    open_origin,
    open_source,
    origin_of,
)
from mocapd.capture.pace import Pace
from mocapd.capture.source_request import SourceRequest
from mocapd.capture.url import UrlSource
from mocapd.capture.webcam.v4l2 import V4l2Source
from mocapd.errors import ConfigError, InputError, MocapdError, UnavailableError
from tests.capture.films import write_capture, write_film


@pytest.mark.parametrize(
    ("spec", "kind", "name"),
    [
        ("usb:1-3:046d:0825:AA01", V4l2Source, "usb:1-3:046d:0825:AA01"),
        ("/dev/video17", V4l2Source, "video17"),
        ("17", V4l2Source, "video17"),
        ("rtsp://u:p@127.0.0.1/live", UrlSource, "rtsp://u:***@127.0.0.1/live"),
        ("http://127.0.0.1:8080/video", UrlSource, "http://127.0.0.1:8080/video"),
    ],
)
def test_live_cameras_by_their_strings(spec: str, kind: type, name: str) -> None:
    source = open_source(spec)
    assert isinstance(source, kind)
    assert source.name == name
    assert not source.recorded
    assert open_source(spec, SourceRequest("left")).name == "left"


def test_a_video_file(tmp_path: Path) -> None:
    source = open_source(
        str(write_film(tmp_path / "walk.avi", 3)), SourceRequest(pace=Pace(live=True))
    )
    assert isinstance(source, FileSource)
    assert source.name == "walk"
    assert source.recorded


def test_one_camera_of_a_folder_under_its_own_name_or_another(tmp_path: Path) -> None:
    folder = write_capture(tmp_path / "capture")
    assert open_source(f"{folder}#cam1").name == "cam1"
    assert open_source(f"{folder}#cam1", SourceRequest("left")).name == "left"
    with pytest.raises(ConfigError, match=r"2 cameras.*#NAME.*cam0, cam1"):
        open_source(str(folder))
    with pytest.raises(ConfigError, match=r"no camera 'cam7'.*cam0, cam1"):
        open_source(f"{folder}#cam7")
    with pytest.raises(ConfigError, match=r"64x48.*'left'.*640x480"):
        open_source(f"{folder}#cam1", SourceRequest("left", (640, 480)))


def test_a_folder_of_one_camera_needs_no_choice(tmp_path: Path) -> None:
    folder = write_capture(tmp_path / "capture", frames=(5,), time_offsets_s=(0.0,))
    assert open_source(str(folder)).name == "cam0"


def test_a_recorded_camera_keeps_its_own_clock_offset(tmp_path: Path) -> None:
    source = open_source(f"{write_capture(tmp_path / 'capture')}#cam1")
    source.open()
    assert source.read().t_ns == 10_000_000
    source.close()


def test_a_simulated_camera_among_others_is_refused() -> None:
    with pytest.raises(ConfigError, match="simulate all cameras"):
        open_source("sim:living_room#cam0")


def test_a_recording_that_is_not_there_or_damaged_is_told_at_the_start(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such camera or file"):
        open_source(str(tmp_path / "gone.mp4"))
    (tmp_path / "bad.mp4").write_bytes(b"no video")
    with pytest.raises(InputError, match=r"bad\.mp4"):
        open_source(str(tmp_path / "bad.mp4"))


@pytest.mark.parametrize(
    ("spec", "error"),
    [
        ("x" * 5000, InputError),
        ("y" * 5000 + "#cam0", InputError),
        ("a\0b", ConfigError),
        ("~nosuchuser/film.mp4", ConfigError),
    ],
)
def test_what_can_be_no_path_is_a_named_error(spec: str, error: type[MocapdError]) -> None:
    with pytest.raises(error, match=r"no such (camera or file|user)|is no path"):
        open_source(spec)


def test_a_file_of_another_size_than_its_calibration_is_told_at_the_start(tmp_path: Path) -> None:
    film = write_film(tmp_path / "a.avi", 3)
    with pytest.raises(ConfigError, match=r"64x48.*640x480"):
        open_source(str(film), SourceRequest(size_px=(640, 480)))


def test_a_wrong_identity_is_a_config_error() -> None:
    with pytest.raises(ConfigError):
        open_source("usb:left")


def test_a_node_that_is_not_there_says_what_to_do() -> None:
    with pytest.raises(UnavailableError, match=r"/dev/video977: no such camera.*mocapd cameras"):
        open_source("977").open()


FOLDER, FILM, NOWHERE = "folder", "film.avi", "nowhere"


@pytest.fixture
def place(tmp_path: Path) -> Path:
    write_capture(tmp_path / FOLDER)
    write_film(tmp_path / FILM, 3)
    return tmp_path


@pytest.mark.parametrize(
    ("address", "origin", "settable", "simulated"),
    [
        ("usb:1-3:046d:0825:A#1", "", True, False),
        ("/dev/video0", "", True, False),
        ("rtsp://u:p#w@127.0.0.1/live#now", "", False, False),
        ("sim:living_room#left", "sim:living_room", False, True),
        (f"{FOLDER}#cam0", FOLDER, False, False),
        (FILM, "", False, False),
        (f"{NOWHERE}#cam0", "", False, False),
    ],
)
def test_what_an_address_says_of_its_camera(
    place: Path, monkeypatch: pytest.MonkeyPatch, address: str, origin: str, settable: bool,
    simulated: bool,
) -> None:  # fmt: skip
    monkeypatch.chdir(place)
    assert origin_of(address) == origin
    assert is_settable(address) == settable
    assert is_simulated(address) == simulated


def test_webcams_are_told_by_their_identity() -> None:
    found = identities_of([("a", "usb:1-3:046D:0825:S"), ("b", "0"), ("c", "sim:x#a")])
    assert {name: str(one) for name, one in found.items()} == {"a": "usb:1-3:046d:0825:S"}


def test_paths_of_a_file_are_meant_from_its_folder_and_nothing_else_is(place: Path) -> None:
    for address in (f"{FOLDER}#cam0", FOLDER, FILM):
        assert address_in_folder(place, address) == str(place / address)
        assert address_in_folder(Path("/"), str(place / address)) == str(place / address)
    for address in ("0", "usb:1-3:046d:0825:", "http://film/x", "sim:living_room#left", NOWHERE):
        assert address_in_folder(place, address) == address


def test_an_origin_knows_its_cameras_its_rig_and_its_frames(place: Path) -> None:
    address = str(place / FOLDER)
    assert cameras_of_origin(address) == ("cam0", "cam1")
    origin = open_origin(address, place, lambda *_: None)
    assert origin.rig.names == ("cam0", "cam1")
    assert origin.count == len(list(origin.frame_sets()))
    source = origin.source(f"{address}#cam1", SourceRequest("left", pace=Pace(live=False)))
    assert (source.name, source.recorded) == ("left", True)


@pytest.mark.parametrize("address", [NOWHERE, "0", "rtsp://u:hunter2@h/x"])
def test_what_is_no_origin_is_told(address: str) -> None:
    with pytest.raises(InputError, match="no such capture folder") as caught:
        cameras_of_origin(address)
    assert "hunter2" not in str(caught.value)


def test_what_is_no_camera_is_told_how_cameras_are_written() -> None:
    assert kind_of(NOWHERE) is None
    with pytest.raises(InputError) as caught:
        open_source(NOWHERE)
    assert caught.value.fix == f"write {SOURCE_FORMS}"
