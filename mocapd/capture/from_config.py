"""From the camera string of a configuration to a source."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from mocapd.boundary.files import is_file, is_folder, user_path
from mocapd.boundary.urls import without_password
from mocapd.capture.base import Source
from mocapd.capture.capture_folder import RecordedCamera, folder_source, load_folder
from mocapd.capture.file import FileSource, probe_video, size_error
from mocapd.capture.pace import Pace
from mocapd.capture.url import UrlSource, is_url
from mocapd.capture.webcam.identity import PREFIX, WebcamIdentity, parse_identity
from mocapd.capture.webcam.v4l2 import V4l2Source, WebcamSettings
from mocapd.errors import ConfigError, InputError

_FORMS = (
    "write usb:PORT:VID:PID:SERIAL (see `mocapd cameras`), /dev/videoN, a video file, "
    "FOLDER#camN of a capture folder, or an rtsp:// or http:// URL"
)


def open_source(
    spec: str,
    name: str | None = None,
    *,
    size_px: tuple[int, int] | None = None,
    settings: WebcamSettings | None = None,
    others: Sequence[WebcamIdentity] = (),
    pace: Pace | None = None,
) -> Source:
    """The source that a camera string means; checked, but not opened yet.

    A recording that is missing or damaged is told here, at the start, and not sought for ever by
    its thread. Simulated webcams (`sim:`) are not made here: all those of a scenario share a film.

    Args:
        name: what to call the camera; without it, what the string says of itself.
        size_px: width and height of its calibration; another size is an error.
        settings: for webcams; `size_px` overrules its size.
        others: identities of the other configured webcams, which are never taken for this one.
        pace: shared by recordings that belong together; None reads them offline.

    Raises ConfigError or InputError.
    """
    pace = pace if pace is not None else Pace(live=False)
    if spec.startswith(PREFIX):
        return _webcam(name or spec, parse_identity(spec), size_px, settings, others)
    if spec.isdigit() or spec.startswith("/dev/"):
        node = Path(f"/dev/video{spec}" if spec.isdigit() else spec)
        return _webcam(name or node.name, node, size_px, settings, others)
    if is_url(spec):
        return UrlSource(name or without_password(spec), spec, size_px)
    if spec.startswith("sim:"):
        raise ConfigError(
            "a simulated camera among others", spec, "simulate all cameras, or none of them"
        )
    path = user_path(spec)
    if is_file(path):
        return _file(path, name or path.stem, size_px, pace)
    folder, mark, camera = str(path).rpartition("#")
    if is_folder(path) or (mark and is_folder(Path(folder))):
        recorded = _recorded(path, "") if is_folder(path) else _recorded(Path(folder), camera)
        _check_size(recorded.video, name or recorded.name, recorded.size_px, size_px)
        return folder_source(recorded, pace, name)
    # also a URL with a typo in its scheme comes here
    raise InputError("no such camera or file", without_password(spec), _FORMS)


def _webcam(
    name: str,
    where: WebcamIdentity | Path,
    size_px: tuple[int, int] | None,
    settings: WebcamSettings | None,
    others: Sequence[WebcamIdentity],
) -> Source:
    settings = settings if settings is not None else WebcamSettings()
    if size_px is not None:
        settings = replace(settings, size_px=size_px)
    return V4l2Source(name, where, settings, tuple(others))


def _file(path: Path, name: str, size_px: tuple[int, int] | None, pace: Pace) -> Source:
    info = probe_video(path)
    _check_size(path, name, info.size_px, size_px)
    return FileSource(name, path, info.fps_hz, pace=pace, size_px=size_px)


def _recorded(folder: Path, camera: str) -> RecordedCamera:
    """One camera of a capture folder; the only one when no name is given."""
    cameras = load_folder(folder).cameras
    names = ", ".join(one.name for one in cameras)
    if not camera and len(cameras) > 1:
        raise ConfigError(
            f"this folder holds {len(cameras)} cameras",
            str(folder),
            f"say which: {folder}#NAME with one of {names}",
        )
    for one in cameras:
        if camera in ("", one.name):
            return one
    raise ConfigError(f"there is no camera {camera!r}", str(folder), f"it has {names}")


def _check_size(
    path: Path, name: str, got_px: tuple[int, int], want_px: tuple[int, int] | None
) -> None:
    if want_px is not None and got_px != want_px:
        raise size_error(str(path), name, got_px, want_px)
