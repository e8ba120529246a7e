"""Which cameras a setup begins with: those of the configuration, else every one that is plugged in."""

from collections.abc import Sequence
from dataclasses import replace

from mocapd.capture.webcam.identity import WebcamIdentity
from mocapd.capture.webcam.webcam_listing import CameraInfo
from mocapd.config.sections import CameraSection
from mocapd.errors import UnavailableError
from mocapd.session.camera_inputs import picture_size
from mocapd.wizard.cameras.same_port import find_port_changes
from mocapd.wizard.draft import DraftCamera

_SIZE_PX = (640, 480)  # of a webcam that was never set up


def configured_cameras(
    cameras: Sequence[CameraSection], saved: Sequence[DraftCamera]
) -> tuple[DraftCamera, ...]:
    """Those of the configuration, in the mode of an earlier setup. Raises MocapdError when one has no
    picture."""
    before = {(one.id, one.source): one for one in saved}
    return tuple(
        before[one.id, one.source]
        if (one.id, one.source) in before
        else DraftCamera(one.id, one.source, picture_size(one), one.fps_hz, one.controls)
        for one in cameras
    )


def plugged_cameras(
    infos: Sequence[CameraInfo], saved: Sequence[DraftCamera]
) -> tuple[DraftCamera, ...]:
    """Every usable node, as in an earlier setup where it was in one, else cam0, cam1, ...

    A saved webcam in another socket keeps its name and gets its new place. Raises UnavailableError
    when there is none.
    """
    usable = [info for info in infos if info.usable and info.captures]
    if not usable:
        told = "; ".join(f"{info.name}: {info.problem}" for info in infos)
        raise UnavailableError(
            f"no camera can be used{f' ({told})' if told else ''}",
            "this machine",
            next((info.fix for info in infos if info.fix), "plug a webcam in"),
        )
    known = {camera.source: camera for camera in where_now(saved, usable)}
    taken = {camera.id for camera in saved}
    free = (f"cam{i}" for i in range(len(taken) + len(usable)) if f"cam{i}" not in taken)
    return tuple(
        known[info.spec] if info.spec in known else DraftCamera(next(free), info.spec, _SIZE_PX)
        for info in usable
    )


def where_now(saved: Sequence[DraftCamera], infos: Sequence[CameraInfo]) -> tuple[DraftCamera, ...]:
    """The saved cameras as they are plugged in now; one that is not keeps its old place."""
    moved = {one.camera: one.now for one in find_port_changes(saved, identities(infos))}
    return tuple(replace(one, source=moved.get(one.id, one.source)) for one in saved)


def identities(infos: Sequence[CameraInfo]) -> tuple[WebcamIdentity, ...]:
    """The webcams among them."""
    return tuple(dict.fromkeys(info.identity for info in infos if info.identity is not None))
