"""The initial cameras of a setup: those of the configuration, or else all plugged-in ones."""

from collections.abc import Sequence
from dataclasses import replace

from mocapd.capture.webcam.identity import WebcamIdentity
from mocapd.capture.webcam.webcam_listing import CameraInfo
from mocapd.config.sections import CameraSection
from mocapd.errors import UnavailableError
from mocapd.session.camera_inputs import picture_size
from mocapd.wizard.cameras.same_port import find_port_changes
from mocapd.wizard.draft import DraftCamera

_SIZE_PX = (640, 480)  # of a webcam without a setup


def configured_cameras(
    cameras: Sequence[CameraSection], saved: Sequence[DraftCamera]
) -> tuple[DraftCamera, ...]:
    """Those of the configuration, in the mode of an earlier setup. Raises MocapdError for one without
    pictures."""
    before = {(camera.id, camera.source): camera for camera in saved}
    return tuple(
        before[camera.id, camera.source]
        if (camera.id, camera.source) in before
        else DraftCamera(
            camera.id, camera.source, picture_size(camera), camera.rate_hz, camera.controls
        )
        for camera in cameras
    )


def plugged_cameras(
    infos: Sequence[CameraInfo], saved: Sequence[DraftCamera]
) -> tuple[DraftCamera, ...]:
    """Every usable node, with its id of an earlier setup if it has one, else cam0, cam1, ...

    A saved webcam in another socket keeps its name and gets its new address. Raises UnavailableError
    for no camera.
    """
    usable = [info for info in infos if info.usable and info.captures]
    if not usable:
        reasons = "; ".join(f"{info.name}: {info.problem}" for info in infos)
        raise UnavailableError(
            f"no camera can be used{f' ({reasons})' if reasons else ''}",
            "this machine",
            next((info.fix for info in infos if info.fix), "plug a webcam in"),
        )
    saved_by_source = {camera.source: camera for camera in where_now(saved, usable)}
    taken = {camera.id for camera in saved}
    free = (f"cam{i}" for i in range(len(taken) + len(usable)) if f"cam{i}" not in taken)
    return tuple(
        saved_by_source[info.spec]
        if info.spec in saved_by_source
        else DraftCamera(next(free), info.spec, _SIZE_PX)
        for info in usable
    )


def where_now(saved: Sequence[DraftCamera], infos: Sequence[CameraInfo]) -> tuple[DraftCamera, ...]:
    """The saved cameras at their present addresses; one that is not plugged in keeps its old one."""
    moved = {change.camera: change.now for change in find_port_changes(saved, identities(infos))}
    return tuple(replace(camera, source=moved.get(camera.id, camera.source)) for camera in saved)


def identities(infos: Sequence[CameraInfo]) -> tuple[WebcamIdentity, ...]:
    """The webcams among them."""
    return tuple(dict.fromkeys(info.identity for info in infos if info.identity is not None))
