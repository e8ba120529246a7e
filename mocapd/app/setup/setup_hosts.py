"""Hosts of a setup without a daemon: with this machine's webcams, or with simulated ones."""

import logging
from dataclasses import replace
from typing import TYPE_CHECKING

from mocapd.boundary.files import is_absent
from mocapd.calibration.calibration_file import FILE_NAME
from mocapd.calibration.saved_sources import require_password, sources_by_masked
from mocapd.errors import ConfigError, InputError
from mocapd.wizard.check.check_settings import CheckSettings
from mocapd.wizard.draft import Draft, DraftCamera
from mocapd.wizard.hosts.own_host import OwnHost
from mocapd.wizard.saving import load_draft

if TYPE_CHECKING:
    from mocapd.config.sections import Config
    from mocapd.wizard.step_names import StepName

_log = logging.getLogger(__name__)


def webcam_host(config: "Config", step: "StepName | None", following: str) -> OwnHost:
    """A host with the configured cameras, else all plugged ones; following: the command to run afterwards. Raises
    MocapdError."""
    from mocapd.capture.webcam.webcam_listing import list_cameras
    from mocapd.wizard.cameras.initial_cameras import (
        configured_cameras,
        identities,
        plugged_cameras,
        where_now,
    )
    from mocapd.wizard.cameras.same_port import find_port_changes
    from mocapd.wizard.setup_keeper import unfinished_cameras

    before, infos = _with_passwords(saved_draft(config, step), config), list_cameras()
    saved = unfinished_cameras(config.state_dir, before.cameras)
    if step is not None:
        for camera in before.cameras:
            require_password(camera.id, camera.source, str(config.state_dir))
        draft = replace(before, cameras=where_now(before.cameras, infos))
    else:
        cameras = (
            configured_cameras(config.camera, saved)
            if config.camera
            else plugged_cameras(infos, saved)
        )
        # reuse earlier input
        draft = Draft(
            cameras=cameras,
            board=before.board,
            stature_m=before.stature_m,
            has_shirt=before.has_shirt,
        )
    return OwnHost(
        draft,
        settings_of(config, following),
        config.state_dir,
        config.cache_dir,
        step,
        nodes=list_cameras,
        moved=find_port_changes(before.cameras, identities(infos)),
    )


def _with_passwords(draft: Draft, config: "Config") -> Draft:
    """Adds passwords of the configuration that the calibration lacks."""
    sources = sources_by_masked((camera.id, camera.source) for camera in config.camera)
    cameras = (replace(c, source=sources.get((c.id, c.source), c.source)) for c in draft.cameras)
    return replace(draft, cameras=tuple(cameras))


def saved_draft(config: "Config", step: "StepName | None") -> Draft:
    """The saved calibration; empty without one, and for all steps without one that can be read, which the next save sets
    aside. Raises ConfigError or InputError if a single `step` needs one."""
    if not is_absent(config.state_dir / FILE_NAME):
        try:
            return load_draft(config.state_dir)
        except (ConfigError, InputError) as error:
            if step is not None:
                raise
            _log.warning("%s: %s: the setup begins without it", error.where, error.what)
            return Draft()
    if step is not None:
        raise ConfigError(
            f"there is no calibration yet of which {step.value!r} could be repeated",
            str(config.state_dir),
            "do all steps: `mocapd calibrate`",
        )
    return Draft()


def settings_of(config: "Config", following: str) -> CheckSettings:
    """The tracking settings of this configuration's daemon."""
    from mocapd.session.camera_inputs import bundler_params

    bundler = bundler_params(config)
    return CheckSettings(config.tracker, config.smoothing.preset, bundler, following)


def demo_host(config: "Config", step: "StepName | None", following: str) -> OwnHost:
    """A host with simulated cameras, board and wearer, which act as each step requires; following: see webcam_host.
    Raises MocapdError."""
    from mocapd.app.terminal.progress import ProgressBars
    from mocapd.calibration.board_spec import BoardKind, BoardSpec
    from mocapd.session.setup_demo import open_demo

    before = saved_draft(config, step)
    with ProgressBars() as progress:
        demo = open_demo(config.cache_dir, progress)
    sizes = {camera.name: camera.size_px for camera in demo.rig.cameras}
    cameras = tuple(
        DraftCamera(name, demo.source_of(name), sizes[name], demo.fps_hz)
        for name, _ in demo.cameras
    )
    draft = before
    if step is None:
        shown = demo.board
        board = BoardSpec(
            BoardKind.CHARUCO, shown.columns, shown.rows, shown.square_m, shown.marker_m,
            shown.dictionary,
        )  # fmt: skip
        # simulated, so the user cannot measure them
        draft = Draft(board=board, stature_m=demo.stature_m, has_shirt=before.has_shirt)
    return OwnHost(
        replace(draft, cameras=cameras),
        settings_of(config, following),
        config.state_dir,
        config.cache_dir,
        step,
        dict(demo.cameras),
        demo.stage.play,
    )
