"""Unsafe settings of a configuration: one line each, for the log and `check-config`."""

import shlex
import stat
from pathlib import Path
from typing import TYPE_CHECKING

from mocapd.boundary.files import is_file
from mocapd.boundary.folders import readable_by_others
from mocapd.boundary.secret_files import narrowing, readers_of
from mocapd.boundary.urls import has_password
from mocapd.config.web_params import is_of_this_machine

if TYPE_CHECKING:
    from mocapd.config.effective import Effective


def unsafe_settings(effective: "Effective") -> list[str]:
    """A line per setting: the possible attack and the fix. Imports numba: call after `prepare_libraries`."""
    return [
        *_camera_passwords(effective),
        *_sites(effective.config.web.allow_origins),
        *_state(effective.config.state_dir),
    ]


def _camera_passwords(effective: "Effective") -> list[str]:
    secret = [camera.id for camera in effective.config.camera if has_password(camera.source)]
    if not secret:
        return []
    names = " and ".join(secret)
    origin = next(s.origin for s in effective.settings if s.key.path == "camera")
    if origin == "command line":
        return [
            f"the password of camera {names} stands on the command line, which every user of this"
            " machine can read: write it into a config file of yours with mode 600"
        ]
    file = effective.file
    if file is not None and origin.startswith(str(file)) and readers_of(file):
        return [
            f"{file} holds the password of camera {names}, and {readers_of(file)} may read it"
            f" ({_mode(file)}): `{narrowing(file)}`"
        ]
    return []


def _sites(origins: tuple[str, ...]) -> list[str]:
    sites = [origin for origin in origins if not is_of_this_machine(origin)]
    if not sites:
        return []
    return [
        f"web.allow_origins lets {' and '.join(sites)} see where the wearer is and moves, once a page from"
        " there was given `mocapd web-link`: leave out what is not played"
    ]


def _state(folder: Path) -> list[str]:
    from mocapd.calibration.calibration_file import FILE_NAME
    from mocapd.calibration.saved_sources import SECRETS

    if not is_file(folder / FILE_NAME):
        return []
    lines = []
    if readable_by_others(folder):
        lines.append(
            f"{folder} may hold pictures of the wearer, and others may look into it"
            f" ({_mode(folder)}): `chmod 700 {shlex.quote(str(folder))}`, as the next save will"
        )
    secrets = folder / SECRETS
    if readable_by_others(secrets):
        lines.append(
            f"{secrets} holds passwords of cameras, and others may read it ({_mode(secrets)}):"
            f" `chmod 600 {shlex.quote(str(secrets))}`"
        )
    return lines


def _mode(path: Path) -> str:
    return f"mode {stat.S_IMODE(path.stat().st_mode):04o}"
