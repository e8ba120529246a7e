"""A daemon on what `mocapd calibrate` has saved."""

import os
from dataclasses import replace
from pathlib import Path

import msgspec
import numpy as np
import pytest

from mocapd.calibration.calibration_file import (
    FILE_NAME,
    LoadedCalibration,
    calibration_of_recording,
    find_calibration,
    load_calibration,
    read_calibration,
)
from mocapd.calibration.calibration_writing import write_calibration
from mocapd.calibration.saved_sources import SECRETS
from mocapd.capture.capture_folder import load_folder
from mocapd.capture.kinds.folder_kind import FolderOrigin
from mocapd.config.sections import CameraSection, Config, ControlsSection, TrackerSection
from mocapd.doctor.gathering.camera_facts import wanted_cameras
from mocapd.errors import ConfigError, InputError
from mocapd.session.session import cameras_of, open_session, session_cameras
from mocapd.wizard.saving import save_draft
from tests.cli.small_capture import write_capture
from tests.wizard.drafts import PORTS, full_draft, source_of


def quiet(_what: str, _done: int, _total: int) -> None: ...


@pytest.fixture
def config(tmp_path: Path) -> Config:
    """No camera is configured; a calibration is saved."""
    state_dir = tmp_path / "state"
    save_draft(full_draft(), state_dir)
    canned = TrackerSection(name="canned", stature_m=1.9)
    return Config(state_dir=state_dir, cache_dir=tmp_path, tracker=canned)


def saved_for(config: Config) -> LoadedCalibration | None:
    return find_calibration(config.rig, config.state_dir, config.sources)


def test_the_saved_calibration_gives_cameras_rig_and_wearer(config: Config) -> None:
    session = open_session(config, quiet)
    assert [camera.spec for camera in session.cameras] == [
        source_of(name, port) for name, port in PORTS.items()
    ]
    assert session.rig is not None
    assert session.rig.names == ("cam0", "cam1")
    assert session.rig_source == str(config.state_dir / "calibration.toml")
    assert session.cameras[0].size_px == (64, 48)
    measured = full_draft().factors
    assert measured is not None
    assert session.shape.stature_m == 1.72
    assert np.array_equal(session.shape.factors, measured)
    assert session.shape.information is not None


def test_the_colours_and_proportions_reach_the_tracker(config: Config) -> None:
    saved = saved_for(config)
    assert saved is not None
    draft = full_draft()
    assert saved.calibration.wearer.shape_factors is not None
    assert draft.factors is not None
    assert np.array_equal(saved.calibration.wearer.shape_factors, draft.factors)
    assert saved.calibration.shirt is not None
    assert len(saved.calibration.shirt.model) == 2  # personal
    assert set(saved.calibration.shirt.white_balance) == {"cam0", "cam1"}


def test_configured_cameras_that_were_calibrated_take_the_rest_from_there(config: Config) -> None:
    moved = CameraSection("cam1", source_of("cam1", "4-4"), fps_hz=15.0)
    session = open_session(replace(config, camera=(moved,)), quiet)
    assert [(one.spec, one.expected_hz) for one in session.cameras] == [(moved.source, 15.0)]
    assert session.rig is not None


def test_configured_cameras_keep_the_controls_that_the_setup_locked(config: Config) -> None:
    gained = CameraSection("cam1", source_of("cam1", "4-4"), controls=ControlsSection(gain=7))
    (camera,) = session_cameras((gained,), saved_for(config), config.state_dir)
    assert camera.controls == ControlsSection(exposure=150, gain=7)


def test_a_configured_camera_is_opened_at_its_calibrated_rate(config: Config) -> None:
    draft = full_draft()
    slow = tuple(replace(camera, fps_hz=15.0) for camera in draft.cameras)
    save_draft(replace(draft, cameras=slow), config.state_dir)
    named = replace(config, camera=(CameraSection("cam1", source_of("cam1", "4-4")),))
    assert [camera.expected_hz for camera in open_session(named, quiet).cameras] == [15.0]
    assert [camera.fps_hz for camera in wanted_cameras(named, saved_for(named))] == [15.0]


def test_other_cameras_do_not_take_it(config: Config, caplog: pytest.LogCaptureFixture) -> None:
    other = CameraSection("cam0", "/dev/video7")
    assert saved_for(replace(config, camera=(other,))) is None
    assert "other cameras" in caplog.text


URL = "rtsp://admin:hunter2@127.0.0.1:9/stream"


def network_config(config: Config) -> Config:
    """The saved calibration is of one network camera."""
    path = config.state_dir / "calibration.toml"
    saved = read_calibration(path)
    one = msgspec.structs.replace(saved.camera[0], source=URL, colour=None)
    write_calibration(path, msgspec.structs.replace(saved, camera=(one,)), {})
    return config


def test_a_network_camera_is_opened_with_its_password(config: Config) -> None:
    saved = saved_for(network_config(config))
    assert saved is not None
    assert session_cameras((), saved, config.state_dir)[0].source == URL


def test_a_password_may_come_from_the_configuration(config: Config) -> None:
    config = network_config(config)
    (config.state_dir / SECRETS).unlink()
    saved = saved_for(replace(config, camera=(CameraSection("cam0", URL),)))
    assert saved is not None


def test_a_password_that_is_nowhere_is_asked_for(config: Config) -> None:
    config = network_config(config)
    (config.state_dir / SECRETS).unlink()
    with pytest.raises(ConfigError, match=r"password of camera 'cam0'.*\*\*\*@") as caught:
        open_session(config, quiet)
    assert SECRETS in caught.value.fix
    assert "[[camera]]" in caught.value.fix


def test_other_cameras_are_told_of_without_a_password(
    config: Config, caplog: pytest.LogCaptureFixture
) -> None:
    other = CameraSection("cam0", "rtsp://other/")
    assert saved_for(replace(network_config(config), camera=(other,))) is None
    assert "admin:***@" in caplog.text
    assert "hunter2" not in caplog.text


def test_a_capture_folder_brings_its_own_unless_one_is_named(
    config: Config, tmp_path: Path
) -> None:
    folder = write_capture(tmp_path / "capture")
    recorded = replace(config, camera=cameras_of(str(folder)))
    assert open_session(recorded, quiet).rig_source == str(folder / "rig.json")
    named = open_session(replace(recorded, rig=config.state_dir), quiet)
    assert named.rig_source == str(config.state_dir / "calibration.toml")


def test_without_anything_the_setup_is_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="mocapd calibrate"):
        open_session(Config(state_dir=tmp_path, cache_dir=tmp_path), quiet)


def test_a_recording_is_tracked_with_it_when_its_cameras_are_there(
    config: Config, tmp_path: Path
) -> None:
    folder = FolderOrigin(load_folder(write_capture(tmp_path / "capture")))
    saved = load_calibration(config.state_dir / FILE_NAME)
    known = calibration_of_recording(saved, folder)
    assert known.wearer.stature_m == 1.72
    assert known.rig is saved.calibration.rig
    alone = replace(saved, tables=type(saved.tables)(
        schema=1, made=saved.tables.made, room=saved.tables.room, camera=saved.tables.camera[:1]
    ))  # fmt: skip
    with pytest.raises(ConfigError, match="no camera 'cam1'"):
        calibration_of_recording(alone, folder)


@pytest.mark.parametrize("kind", ["pipe", "link to nothing", "folder"])
def test_a_calibration_that_cannot_be_read_is_never_taken_for_none(
    tmp_path: Path, kind: str
) -> None:
    path = tmp_path / FILE_NAME
    match kind:
        case "pipe":
            os.mkfifo(path)
        case "folder":
            path.mkdir()
        case _:
            path.symlink_to(tmp_path / "share" / FILE_NAME)
    with pytest.raises(InputError):
        saved_for(Config(state_dir=tmp_path))
    path.rmdir() if kind == "folder" else path.unlink()
    assert saved_for(Config(state_dir=tmp_path)) is None
