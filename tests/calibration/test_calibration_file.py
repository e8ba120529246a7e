"""The saved calibration: what is written is what is read, damage is told, and nothing is lost when it
cannot be written."""

import math
import os
import random
import subprocess
import tomllib
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
import tomli_w

from mocapd.calibration.board_spec import BoardKind, BoardSpec
from mocapd.calibration.calibration_file import FILE_NAME, from_saved, read_calibration
from mocapd.calibration.calibration_writing import rewrite_sources, write_calibration
from mocapd.calibration.saved_calibration import (
    ColourFit,
    LensFit,
    Made,
    RoomFit,
    SavedCalibration,
    SavedCamera,
    SavedWearer,
)
from mocapd.calibration.saved_sources import SECRETS
from mocapd.capture.webcam.controls import Controls
from mocapd.errors import CannotCreateError, ConfigError, InputError
from mocapd.types import LabelledPicture

ONE = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def camera(name: str, colour: bool = False) -> SavedCamera:
    return SavedCamera(
        id=name,
        label="left, on the shelf",
        source=f"usb:1-3:046d:0825:{name}",
        size_px=(64, 48),
        K=((60.123456789, 0.0, 32.0), (0.0, 60.0, 24.0), (0.0, 0.0, 1.0)),
        dist=(0.1, -0.2, 0.0, 0.0, 0.001),
        R=ONE,
        t_m=(0.1, -1.2, 2.5),
        rms_px=0.31,
        lens=LensFit(rms_px=0.2, held_out_px=0.3, views=12, focal_deviation=0.001),
        controls=Controls(auto_exposure=False, exposure=150),
        colour=ColourFit(picture="-", strokes="-", W=ONE) if colour else None,
    )


def saved_calibration() -> SavedCalibration:
    return SavedCalibration(
        schema=1,
        made=Made(when=datetime(2026, 11, 21, 10, 0, tzinfo=UTC), by="ann", mocapd="0.2.0"),
        room=RoomFit(method="board", rms_px=0.4, play_area_cm=0.3),
        wearer=SavedWearer(stature_m=1.71, proportions={"arm_girth": 1.2}, personal_colours=True),
        board=BoardSpec(BoardKind.CHARUCO, 5, 7, 0.05, 0.0375, two_sided=True),
        camera=(camera("left", colour=True), camera("right/2")),
    )


def pictures(shade: int = 0) -> dict[str, LabelledPicture]:
    strokes = np.zeros((48, 64), np.uint8)
    strokes[10:20, 10:20] = 3
    return {"left": LabelledPicture(np.full((48, 64, 3), shade, np.uint8), strokes)}


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "state" / FILE_NAME
    write_calibration(path, saved_calibration(), pictures())
    return path


def test_what_is_read_is_what_was_written(path: Path) -> None:
    read = read_calibration(path)
    wanted = saved_calibration()
    assert read.camera[1] == wanted.camera[1]
    assert (read.made, read.room, read.wearer, read.board) == (
        wanted.made,
        wanted.room,
        wanted.wearer,
        wanted.board,
    )
    known = from_saved(read, path).assuming(1.9)
    assert known.rig is not None
    assert known.shirt is not None
    left = known.shirt.white_balance["left"]
    assert np.array_equal(left.pixels, pictures()["left"].pixels)
    assert np.array_equal(left.labels, pictures()["left"].labels)
    assert known.wearer.stature_m == 1.71
    assert known.wearer.shape_factors is not None
    assert known.wearer.shape_factors.tolist() == [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.2]
    assert len(known.shirt.model) == 1
    assert known.rig.names == ("left", "right/2")
    assert known.rig.cameras[0].K[0, 0] == 60.123456789


def test_people_can_read_it(path: Path) -> None:
    text = path.read_text()
    assert text.startswith("# The calibration of mocapd's cameras")
    assert "size_px = [64, 48]" in text
    assert "[60.123456789, 0.0, 32.0]," in text


def test_the_one_before_is_kept_with_its_pictures_and_older_ones_go(path: Path) -> None:
    for shade in (1, 2):
        write_calibration(path, saved_calibration(), pictures(shade))
    names = sorted(one.name for one in path.parent.iterdir())
    assert names == ["calibration.previous.toml", "calibration.toml", "colours"]
    assert len(list((path.parent / "colours").iterdir())) == 4
    for file, shade in ((path, 2), (path.with_name("calibration.previous.toml"), 1)):
        shirt = from_saved(read_calibration(file), file).shirt
        assert shirt is not None
        assert shirt.white_balance["left"].pixels[0, 0, 0] == shade


@pytest.mark.parametrize("blocked", ["colours", "calibration.previous.toml"])
def test_what_cannot_be_written_leaves_the_one_before(path: Path, blocked: str) -> None:
    before = path.read_bytes()
    place = path.parent / blocked
    if place.is_dir():  # nothing can be made in a file
        place.rename(path.parent / "away")
        place.write_text("in the way")
    else:
        place.mkdir()
        (place / "x").write_text("in the way")
    with pytest.raises(CannotCreateError, match="untouched"):
        write_calibration(path, saved_calibration(), pictures(9))
    assert path.read_bytes() == before


def test_a_camera_gets_another_port_and_all_else_stays(path: Path) -> None:
    before = read_calibration(path)
    rewrite_sources(path, {"left": "usb:2-1:046d:0825:left"})
    after = read_calibration(path)
    assert after.camera[0].source == "usb:2-1:046d:0825:left"
    assert after.camera[1:] == before.camera[1:]
    assert after.camera[0].colour == before.camera[0].colour


def mode(path: Path) -> int:
    return path.stat().st_mode & 0o777


def test_nobody_else_can_see_the_wearer(path: Path) -> None:
    write_calibration(path, saved_calibration(), pictures(1))
    for one in (path.parent, *path.parent.rglob("*")):
        assert mode(one) == (0o700 if one.is_dir() else 0o600), one


def test_what_an_earlier_version_left_open_is_closed_at_the_next_save(path: Path) -> None:
    folders = (path.parent, path.parent / "colours")
    for one in (*folders, *path.parent.rglob("*")):
        one.chmod(0o755 if one.is_dir() else 0o644)
    write_calibration(path, saved_calibration(), pictures())
    assert {mode(one) for one in folders} == {0o700}
    assert {mode(one) for one in path.parent.rglob("*") if one.is_file()} == {0o600}


def test_a_folder_that_somebody_named_for_a_file_keeps_its_rights(tmp_path: Path) -> None:
    (tmp_path / "shared").mkdir(mode=0o755)
    path = tmp_path / "shared" / "out.toml"
    write_calibration(path, saved_calibration(), pictures(), own_folder=False)
    assert (mode(path.parent), mode(path), mode(path.parent / "colours")) == (0o755, 0o600, 0o700)


def test_what_was_half_written_when_a_save_was_killed_goes(path: Path) -> None:
    dead = subprocess.Popen(["true"])
    dead.wait()
    left = [
        path.parent / f".calibration.{dead.pid}.a1b2c3.toml",
        path.parent / "colours" / f".left-0123456789ab.{dead.pid}.a1b2c3.png",
    ]
    for one in left:
        one.write_bytes(b"half")
    write_calibration(path, saved_calibration(), pictures())
    assert not any(one.exists() for one in left)


URL = "rtsp://admin:hunter2@cam.lan/stream"
SHOWN = "rtsp://admin:***@cam.lan/stream"


def network_calibration(url: str = URL) -> SavedCalibration:
    one = msgspec.structs.replace(camera("door"), source=url, lens=None)
    return msgspec.structs.replace(saved_calibration(), camera=(one, camera("right")))


def everything_but_the_secrets(folder: Path) -> str:
    files = (one for one in folder.rglob("*") if one.is_file() and one.name != SECRETS)
    return "".join(one.read_bytes().decode("utf-8", "replace") for one in files)


def test_a_password_is_kept_apart_and_comes_back(path: Path) -> None:
    for _ in range(2):  # the one before is of the same cameras
        write_calibration(path, network_calibration(), {})
    assert f'source = "{SHOWN}"' in path.read_text()
    assert "hunter2" not in everything_but_the_secrets(path.parent)
    assert mode(path.parent / SECRETS) == 0o600
    for file in (path, path.with_name("calibration.previous.toml")):
        assert read_calibration(file).camera[0].source == URL


def test_a_new_password_takes_the_place_of_the_old_and_goes_with_its_camera(path: Path) -> None:
    write_calibration(path, network_calibration(), {})
    write_calibration(path, network_calibration(URL.replace("hunter2", "new")), {})
    assert read_calibration(path).camera[0].source == "rtsp://admin:new@cam.lan/stream"
    rewrite_sources(path, {"right": "usb:2-1:046d:0825:right"})
    assert read_calibration(path).camera[0].source == "rtsp://admin:new@cam.lan/stream"
    for _ in range(2):
        write_calibration(path, saved_calibration(), pictures())
    assert not (path.parent / SECRETS).exists()


def test_a_calibration_of_an_earlier_version_loses_its_password_at_the_next_write(
    path: Path,
) -> None:
    write_calibration(path, network_calibration(), {})
    (path.parent / SECRETS).unlink()
    path.write_text(path.read_text().replace(SHOWN, URL))
    saved = read_calibration(path)
    assert saved.camera[0].source == URL
    write_calibration(path, saved, {})
    assert "hunter2" not in everything_but_the_secrets(path.parent)
    for file in (path, path.with_name("calibration.previous.toml")):
        assert read_calibration(file).camera[0].source == URL


def test_a_file_of_passwords_that_is_damaged_is_named(path: Path) -> None:
    write_calibration(path, network_calibration(), {})
    (path.parent / SECRETS).write_text("[[camera]]\nid = 3\n")
    with pytest.raises(ConfigError, match=SECRETS):
        read_calibration(path)


def _set(*keys: Any) -> Callable[[Any], None]:
    *way, last, value = keys

    def change(data: Any) -> None:
        for key in way:
            data = data[key]
        if value is None:
            del data[last]
        else:
            data[last] = value

    return change


DAMAGES = {
    "schema": (_set("schema", 99), "has schema 99"),
    "no schema": (_set("schema", None), "has no 'schema'"),
    "when": (_set("made", "when", "yesterday"), "made.when"),
    "method": (_set("room", "method", "guess"), "room.method"),
    "rms": (_set("room", "rms_px", -1.0), "room.rms_px"),
    "stature": (_set("wearer", "stature_m", 17.1), "wearer.stature_m"),
    "proportion": (_set("wearer", "proportions", "arm_girth", 0.0), "wearer.proportions"),
    "unknown proportion": (_set("wearer", "proportions", "nose", 1.0), "nose"),
    "board": (_set("board", "columns", 1), "too few"),
    "no camera": (_set("camera", []), "camera"),
    "twice": (_set("camera", 1, "id", "left"), "two cameras have one id"),
    "no id": (_set("camera", 0, "id", ""), r"camera\[0\]\.id|camera\[\.\.\.\]\.id"),
    "source": (_set("camera", 0, "source", None), "source"),
    "size": (_set("camera", 0, "size_px", [64]), "size_px"),
    "K": (_set("camera", 0, "K", 0, [60.0, 5.0, 32.0]), "'left': 'K' is not"),
    "K of text": (_set("camera", 0, "K", 0, 0, "wide"), "K"),
    "dist": (_set("camera", 0, "dist", [0.0, 0.0]), "dist"),
    "R": (_set("camera", 0, "R", 0, 0, 0.5), "not a rotation"),
    "R of a mirrored world": (_set("camera", 0, "R", 0, 0, -1.0), "mirrors"),
    "t": (_set("camera", 1, "t_m", 2, math.nan), r"'camera\[1\]\.t_m\[2\]' is not finite"),
    "controls": (_set("camera", 0, "controls", "exposure", "long"), "exposure"),
    "views": (_set("camera", 0, "lens", "views", 10**12), "views"),  # took a terabyte
    "rate": (_set("camera", 0, "fps_hz", 1e-300), "fps_hz"),
    "huge": (_set("camera", 0, "controls", "exposure", 10**15), "exposure.* far too large"),
    "far": (_set("camera", 0, "t_m", 0, 1e300), r"t_m\[0\]' is far too large"),
    "W": (_set("camera", 0, "colour", "W", 0, 0, math.inf), "W.* is not finite"),
}


@pytest.mark.parametrize("name", DAMAGES)
def test_damage_is_told_with_file_and_place(path: Path, name: str) -> None:
    change, says = DAMAGES[name]
    data = tomllib.loads(path.read_text())
    change(data)
    path.write_text(tomli_w.dumps(data))
    with pytest.raises(ConfigError, match=says) as caught:
        read_calibration(path)
    assert str(path) in str(caught.value)
    assert caught.value.fix


def test_half_a_file_and_no_file_are_told(path: Path) -> None:
    path.write_text(path.read_text()[:700])
    with pytest.raises(ConfigError, match="calibrate again"):
        read_calibration(path)
    path.unlink()
    with pytest.raises(InputError, match="mocapd calibrate"):
        read_calibration(path)


def test_a_picture_that_is_gone_is_named(path: Path) -> None:
    saved = read_calibration(path)
    assert saved.camera[0].colour is not None
    (path.parent / saved.camera[0].colour.strokes).unlink()
    with pytest.raises(InputError, match=r"_strokes\.png"):
        from_saved(saved, path)


@pytest.mark.parametrize(
    "text", ["schema = " + "9" * 5000, "a = " + "[" * 2000, "a" + ".a" * 600 + " = 1.0"]
)
def test_no_text_ends_in_a_traceback(path: Path, text: str) -> None:
    path.write_text(text)
    with pytest.raises(ConfigError, match="not valid TOML"):
        read_calibration(path)


@pytest.mark.parametrize("place", ["/dev/zero", "pipe"])
def test_a_picture_that_is_no_file_is_not_waited_for(path: Path, place: str) -> None:
    """`picture = "/dev/zero"` in a calibration that somebody gave you ate the memory."""
    os.mkfifo(path.parent / "pipe")
    saved = read_calibration(path)
    colour = saved.camera[0].colour
    assert colour is not None
    there = msgspec.structs.replace(
        saved.camera[0], colour=msgspec.structs.replace(colour, picture=place)
    )
    with pytest.raises(InputError, match="no regular file"):
        from_saved(msgspec.structs.replace(saved, camera=(there,)), path)


def test_changed_bytes_end_in_a_value_or_a_named_error(path: Path) -> None:
    rng = random.Random(8)
    files = [path, *sorted((path.parent / "colours").iterdir())]
    whole = {file: file.read_bytes() for file in files}
    refused = 0
    for _ in range(150):
        file = rng.choice(files)
        data = bytearray(whole[file])
        for _ in range(rng.choice((1, 1, 4))):
            data[rng.randrange(len(data))] = rng.randrange(256)
        file.write_bytes(data)
        try:
            from_saved(read_calibration(path), path)
        except (ConfigError, InputError):
            refused += 1
        file.write_bytes(whole[file])
    assert refused > 30
