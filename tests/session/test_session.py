"""What a run works on: calibration that comes with the cameras, and what the config gives itself."""

from dataclasses import replace
from pathlib import Path

import pytest

from mocapd.body.shape import skeleton_of
from mocapd.calibration.from_origin import from_capture
from mocapd.capture.capture_folder import load_folder
from mocapd.config.sections import CameraSection, Config, TrackerSection
from mocapd.errors import ConfigError, InputError
from mocapd.session.camera_inputs import reductions
from mocapd.session.session import cameras_of, open_session
from mocapd.session.tracker_setup import cache_resources
from mocapd.shirt.colour.model_pictures import read_model, stroked_folder
from mocapd.types import Rig
from tests.cli.small_capture import SIZE_PX, camera_entry, write_capture, write_rig, write_stroked
from tests.geometry.rigs import ring

pytestmark = pytest.mark.kernels


@pytest.fixture
def capture(tmp_path: Path) -> Path:
    return write_capture(tmp_path / "capture")


def quiet(_what: str, _done: int, _total: int) -> None: ...


def config_of(capture: Path) -> Config:
    return Config(
        camera=cameras_of(str(capture)),
        tracker=TrackerSection(name="canned"),
        cache_dir=capture.parent,
    )


def test_the_cameras_of_a_folder_bring_their_rig_and_the_wearer(capture: Path) -> None:
    session = open_session(config_of(capture), quiet)
    assert session.rig is not None
    assert session.rig.names == ("cam0", "cam1")
    assert [camera.source.name for camera in session.cameras] == ["cam0", "cam1"]
    assert session.rig_source == str(capture / "rig.json")
    assert skeleton_of(session.shape).rest_m[:, 1].max() < 1.7


def test_the_configs_own_rig_goes_before_the_folders(capture: Path, tmp_path: Path) -> None:
    own = write_rig(tmp_path, [camera_entry("cam1", 0.1), camera_entry("cam0", 0.2)])
    session = open_session(replace(config_of(capture), rig=own), quiet)
    assert session.rig is not None
    assert session.rig_source == str(own)
    assert [camera.source.name for camera in session.cameras] == ["cam1", "cam0"]


@pytest.mark.parametrize(
    ("size_px", "by"),
    [((320, 240), 1), ((640, 480), 2), ((960, 540), 1), ((1280, 720), 4), ((1920, 1080), 2)],
)
def test_pictures_are_decoded_to_what_the_tracker_averages_them_from(
    size_px: tuple[int, int], by: int
) -> None:
    rig = Rig((replace(ring(1)[0], size_px=size_px),))
    assert reductions("auto", rig) == {rig.names[0]: by}
    assert not reductions("wang2011", rig)  # which needs them whole
    assert not reductions("canned", None)


def test_webcams_need_no_rig_where_the_tracker_needs_none() -> None:
    camera = CameraSection("left", "/dev/video0")
    config = Config(camera=(camera,), tracker=TrackerSection(name="canned"))
    session = open_session(config, quiet)
    assert session.rig is None
    assert session.cameras[0].expected_hz == 30.0


def test_one_camera_without_a_rig_is_tried_where_it_probably_stands(
    capture: Path, cache_home: Path, caplog: pytest.LogCaptureFixture
) -> None:
    camera = CameraSection("webcam", str(capture / "cam0.mp4"))
    session = open_session(Config(camera=(camera,), cache_dir=cache_home / "mocapd"), quiet)
    assert session.rig is not None
    assert session.rig_source == "assumed"
    assert [(one.name, one.size_px) for one in session.rig.cameras] == [("webcam", SIZE_PX)]
    assert "'webcam' is not calibrated" in caplog.text
    assert session.tracker.name == "auto"


def test_several_cameras_without_a_rig_are_refused_before_anything_long_is_made(
    capture: Path,
) -> None:
    cameras = tuple(CameraSection(name, str(capture / f"{name}.mp4")) for name in ("cam0", "cam1"))
    with pytest.raises(ConfigError, match="--rig"):
        open_session(Config(camera=cameras, cache_dir=capture), quiet)
    assert not list(capture.glob("pose_database*"))


def test_the_best_that_can_run_is_the_usual_one() -> None:
    assert TrackerSection().name == "auto"


def test_what_the_config_says_of_losing_track_reaches_the_tracker(tmp_path: Path) -> None:
    resources = cache_resources(tmp_path, quiet, TrackerSection(coast_s=0.9).tracking)
    assert resources.tracking is not None
    assert resources.tracking.coast_s == 0.9


def test_simulated_cameras_mix_with_no_others() -> None:
    cameras = (CameraSection("a", "sim:living_room#cam0"), CameraSection("b", "/dev/video0"))
    with pytest.raises(ConfigError, match="one scenario"):
        open_session(Config(camera=cameras), quiet)


def test_the_inputs_of_a_folder_hold_strokes_of_every_colour(capture: Path) -> None:
    write_stroked(capture / "scribble" / "cam1.png", range(1, 5))
    known = from_capture(load_folder(capture)).assuming(1.9)
    assert known.wearer.stature_m == 1.7
    assert known.shirt is not None
    assert set(known.shirt.white_balance) == {"cam1"}
    assert set(known.shirt.model[0].labels.ravel().tolist()) == set(range(11))


def test_the_inputs_of_the_config_name_what_is_missing(tmp_path: Path) -> None:
    camera = CameraSection("left", "/dev/video0", white_balance=tmp_path / "left.png")
    with pytest.raises(InputError, match=r"left\.png: no such file"):
        open_session(Config(camera=(camera,), tracker=TrackerSection(name="canned")), quiet)


def test_a_folder_of_pictures_is_read_by_one_rule_wherever_it_is_named(capture: Path) -> None:
    """Ground truth beside the pictures stopped `shirt.colour_model`, but not a capture's model/."""
    folder = capture / "model"
    (folder / "0_labels.png").write_bytes((folder / "0.png").read_bytes())
    write_stroked(folder / "by_the_window.png", range(1, 5))
    named = stroked_folder(folder)
    assert named == load_folder(capture).model
    assert [one.name for one in named] == ["0.png", "by_the_window.png"]


def test_a_model_is_checked(tmp_path: Path) -> None:
    folder = tmp_path / "model"
    folder.mkdir()
    with pytest.raises(InputError, match="holds no image"):
        stroked_folder(folder)
    write_stroked(folder / "0.png", range(1, 6))
    write_stroked(folder / "1.png", range(6, 11))
    assert len(read_model(stroked_folder(folder))) == 2
    (folder / "0_strokes.png").write_bytes(b"no picture")
    with pytest.raises(InputError, match=r"0_strokes\.png: is neither PNG nor JPEG"):
        read_model(stroked_folder(folder))
