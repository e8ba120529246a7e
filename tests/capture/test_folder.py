"""Capture folders: what they hold, how their frames pair, and what is said of broken ones."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from mocapd.capture.capture_folder import frame_sets, load_folder, sources_in_step
from mocapd.capture.file import FileSource
from mocapd.errors import ConfigError, InputError, MocapdError
from mocapd.shirt.colour.strokes import strokes_path
from tests.capture.films import number_of, write_capture, write_film

STAMPED = (
    Path(__file__).parent / "stamped"
)  # films whose frames carry their number, made with ffmpeg


def edit_rig(folder: Path, edit: Callable[[list[dict[str, Any]]], object]) -> None:
    rig = json.loads((folder / "rig.json").read_text())
    edit(rig["cameras"])
    (folder / "rig.json").write_text(json.dumps(rig))


def test_a_folder_says_what_it_holds(tmp_path: Path) -> None:
    path = write_capture(tmp_path / "capture")
    (path / "scribble").mkdir()
    (path / "model").mkdir()
    for name in ("scribble/cam0", "model/0", "model/1"):
        (path / f"{name}.png").touch()
        (path / f"{name}_strokes.png").touch()
    (path / "model" / "0_labels.png").touch()  # ground truth: none of a tracker's business
    folder = load_folder(path)
    assert folder.rig.names == ("cam0", "cam1")
    assert folder.stature_m == 1.72
    assert folder.fps_hz == 30.0
    assert [camera.time_offset_s for camera in folder.cameras] == [0.0, 0.01]
    assert [camera.frames for camera in folder.cameras] == [12, 12]
    scribbles = [camera.scribble for camera in folder.cameras]
    assert scribbles[0] is not None
    assert strokes_path(scribbles[0]).name == "cam0_strokes.png"
    assert scribbles[1] is None
    assert [image.name for image in folder.model] == ["0.png", "1.png"]


def test_frames_of_one_index_come_together_each_with_its_own_time(tmp_path: Path) -> None:
    sets = list(frame_sets(load_folder(write_capture(tmp_path / "capture"))))
    assert len(sets) == 12
    for index, frames in enumerate(sets):
        t_ns = round(index / 30.0 * 1e9)
        assert frames.t_ns == t_ns
        assert {name: frame.t_ns for name, frame in frames.frames.items()} == {
            "cam0": t_ns,
            "cam1": t_ns + 10_000_000,
        }
        assert frames.spread_ns == 10_000_000
        assert {number_of(frame.pixels) for frame in frames.frames.values()} == {index}


def test_a_camera_that_ends_early_is_absent_and_the_rest_goes_on(tmp_path: Path) -> None:
    path = write_capture(tmp_path / "capture", frames=(5, 9))
    sets = list(frame_sets(load_folder(path)))
    assert [tuple(one.frames) for one in sets] == [("cam0", "cam1")] * 5 + [("cam1",)] * 4
    assert [one.t_ns for one in sets] == sorted(one.t_ns for one in sets)


def test_a_damaged_frame_does_not_shift_the_pairing(tmp_path: Path) -> None:
    path = write_capture(tmp_path / "capture")
    film = path / "cam1.avi"
    data = bytearray(film.read_bytes())
    starts = [i for i in range(len(data) - 2) if data[i : i + 3] == b"\xff\xd8\xff"]
    data[starts[4] : starts[5] - 8] = bytes(starts[5] - 8 - starts[4])
    film.write_bytes(data)
    sets = list(frame_sets(load_folder(path)))
    assert len(sets) == 12
    assert tuple(sets[4].frames) == ("cam0",)
    assert all(
        number_of(frame.pixels) == index
        for index, one in enumerate(sets)
        for frame in one.frames.values()
    )


def test_a_video_of_another_rate_is_timed_by_its_own_frames(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = write_capture(tmp_path / "capture", frames=(30, 25))
    write_film(path / "cam1.avi", 25, 25.0)
    folder = load_folder(path)
    assert [camera.fps_hz for camera in folder.cameras] == [30.0, 25.0]
    assert "'fps' is 30, but the frames of cam1.avi are stamped at 25 Hz" in caplog.text
    sets = list(frame_sets(folder))
    for one in sets:
        for name, rate_hz, late_ns in (("cam0", 30.0, 0), ("cam1", 25.0, 10_000_000)):
            if name in one.frames:
                frame = one.frames[name]
                assert frame.t_ns == round(number_of(frame.pixels) * 1e9 / rate_hz) + late_ns
        assert one.spread_ns < 17e6
    assert sum(len(one.frames) for one in sets) == 55
    assert len(sets) <= 35


def test_frames_that_were_dropped_keep_the_others_at_their_times(tmp_path: Path) -> None:
    path = write_capture(tmp_path / "capture", frames=(30, 30))
    shutil.copy(
        STAMPED / "dropped.mp4", path / "cam1.mp4"
    )  # by a recorder that lost frames 10 to 15
    edit_rig(path, lambda cameras: cameras[1].update(file="cam1.mp4", time_offset_s=0.0))
    sets = list(frame_sets(load_folder(path)))
    assert [one.frames["cam0"].seq for one in sets] == list(range(30))
    assert [one.frames["cam0"].seq for one in sets if len(one.frames) == 1] == list(range(10, 16))
    for one in sets:
        assert {number_of(frame.pixels) for frame in one.frames.values()} == {
            one.frames["cam0"].seq
        }


def test_a_video_that_begins_later_than_its_sound_is_later(tmp_path: Path) -> None:
    path = write_capture(tmp_path / "capture", frames=(30, 30))
    shutil.copy(STAMPED / "late.mp4", path / "cam1.mp4")  # six frames after its sound
    edit_rig(path, lambda cameras: cameras[1].update(file="cam1.mp4", time_offset_s=0.0))
    together = [one for one in frame_sets(load_folder(path)) if len(one.frames) == 2]
    assert {one.frames["cam0"].seq - number_of(one.frames["cam1"].pixels) for one in together} == {
        6
    }


def test_leaving_early_closes_the_videos(tmp_path: Path) -> None:
    sources = [FileSource(name, write_film(tmp_path / name, 9)) for name in ("a.avi", "b.avi")]
    sets = sources_in_step(sources)
    next(sets)
    sets.close()  # type: ignore[attr-defined]  # a generator
    for source in sources:
        with pytest.raises(MocapdError):
            source.read()


def test_videos_without_a_rig_play_in_step(tmp_path: Path) -> None:
    sources = [FileSource(name, write_film(tmp_path / name, 4)) for name in ("a.avi", "b.avi")]
    sets = list(sources_in_step(sources))
    assert [tuple(one.frames) for one in sets] == [("a.avi", "b.avi")] * 4


def test_another_size_than_the_calibration_names_both_and_the_file(tmp_path: Path) -> None:
    path = write_capture(tmp_path / "capture", size_px=(96, 64))
    with pytest.raises(ConfigError, match=r"cam0\.avi.*96x64.*64x48"):
        load_folder(path)


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (lambda cameras: cameras[1].pop("K"), r"cam1.*'K' is missing"),
        (lambda cameras: cameras[1].update(fps="fast"), r"cam1.*'fps': 'fast' is no number"),
        (lambda cameras: cameras[1].update(fps=0), r"cam1.*'fps': 0 is not from 0.01 to 1000"),
        (lambda cameras: cameras[1].update(fps=1e-300), r"cam1.*'fps': 1e-300 is not from"),
        (lambda cameras: cameras[1].update(fps=10**400), r"cam1.*'fps'.*too many digits"),
        (lambda cameras: cameras[0].update(time_offset_s=float("nan")), r"cam0.*'time_offset_s'"),
        (lambda cameras: cameras[0].update(lost_frames=[[3]]), r"cam0.*pairs of frames"),
        (lambda cameras: cameras[0].update(lost_frames="all"), r"cam0.*pairs of frames"),
        (lambda cameras: cameras[0].update(lost_frames=[[0, 1e9]]), r"cam0.*'lost_frames'"),
        (lambda cameras: cameras[0].update(time_offset_s=1e308), r"cam0.*'time_offset_s': 1e\+308"),
        (lambda cameras: cameras[0].update(file=7), r"cam0.*'file'"),
    ],
)
def test_a_wrong_rig_file_is_a_config_error_naming_the_field(
    tmp_path: Path, edit: Callable[[list[dict[str, Any]]], object], said: str
) -> None:
    path = write_capture(tmp_path / "capture")
    edit_rig(path, edit)
    with pytest.raises(ConfigError, match=said):
        load_folder(path)


@pytest.mark.parametrize("name", ["x" * 5000 + ".avi", "a\0b.avi"])
def test_a_video_whose_name_can_be_none_is_an_input_error(tmp_path: Path, name: str) -> None:
    path = write_capture(tmp_path / "capture")
    edit_rig(path, lambda cameras: cameras[0].update(file=name))
    with pytest.raises(InputError, match="no such video file"):
        load_folder(path)


@pytest.mark.parametrize("gone", ["rig.json", "cam1.avi"])
def test_a_missing_file_is_an_input_error_naming_it(tmp_path: Path, gone: str) -> None:
    path = write_capture(tmp_path / "capture")
    (path / gone).unlink()
    with pytest.raises(InputError, match=gone):
        load_folder(path)


def test_every_camera_without_a_video_is_named(tmp_path: Path) -> None:
    path = write_capture(tmp_path / "capture", (3, 3, 3), (0.0, 0.0, 0.0))
    (path / "cam1.avi").rename(path / "camera1.avi")
    (path / "cam2.avi").unlink()
    (path / "._cam2.avi").touch()
    said = (
        r"cam1\.avi of camera 'cam1', cam2\.avi of camera 'cam2'; camera1\.avi is of no camera -- "
    )
    with pytest.raises(InputError, match=said):
        load_folder(path)


@pytest.mark.parametrize(
    "subject",
    ["{}", "[]", *(f'{{"stature_m": {value}}}' for value in (172, '"tall"', "true", "1" * 999))],
)
def test_a_wrong_subject_is_a_config_error(tmp_path: Path, subject: str) -> None:
    path = write_capture(tmp_path / "capture")
    (path / "subject.json").write_text(subject)
    with pytest.raises(ConfigError, match=r"subject\.json.*stature_m"):
        load_folder(path)


def test_an_image_without_its_strokes_is_an_input_error(tmp_path: Path) -> None:
    path = write_capture(tmp_path / "capture")
    (path / "model").mkdir()
    (path / "model" / "0.png").touch()
    with pytest.raises(InputError, match=r"0_strokes\.png"):
        load_folder(path)


@pytest.mark.parametrize("folder", ["model", "scribble"])
def test_strokes_without_their_image_are_named(tmp_path: Path, folder: str) -> None:
    path = write_capture(tmp_path / "capture")
    (path / folder).mkdir()
    (path / folder / "cam0_strokes.png").touch()
    with pytest.raises(
        InputError, match=r"cam0_strokes\.png: the picture .* put cam0\.png into the same folder"
    ):
        load_folder(path)


def test_what_other_systems_leave_in_a_folder_is_passed_over(tmp_path: Path) -> None:
    path = write_capture(tmp_path / "capture")
    (path / "model").mkdir()
    for name in ("._0.png", "._0_strokes.png", "Thumbs.db", ".DS_Store", "desktop.ini"):
        (path / "model" / name).write_bytes(b"none of ours")
    assert load_folder(path).model == ()


def test_a_development_capture_loads_whole(dev_captures: Callable[[str], Path]) -> None:
    folder = load_folder(dev_captures("pair_outdoor_async"))
    assert folder.rig.names == ("cam0", "cam1")
    assert folder.cameras[1].time_offset_s == pytest.approx(0.0105, abs=1e-3)
    assert len(folder.model) == 5
    first = next(frame_sets(folder))
    assert all(frame.pixels.shape == (480, 640, 3) for frame in first.frames.values())


def test_what_is_no_folder_is_told_from_what_is_absent(tmp_path: Path) -> None:
    """`mocapd eval` said of a recording that is there to check the path."""
    file = tmp_path / "a.mcap"
    with pytest.raises(InputError, match=r"no such capture folder -- .*rig\.json"):
        load_folder(file)
    file.touch()
    with pytest.raises(InputError, match=r"is no capture folder -- .*rig\.json"):
        load_folder(file)
