"""The machine's camera nodes and the cameras in use: assignment, problems, and modes that would fit.

A node in use by the setup reports "busy"; such reports are left out here.
"""

from collections.abc import Mapping, Sequence

from mocapd.capture.camera_thread.capture_status import CaptureState, CaptureStatus
from mocapd.capture.kinds.source_kinds import identity_of
from mocapd.capture.webcam.usb_bandwidth import Mode, crowded_buses, lower_mode
from mocapd.capture.webcam.webcam_listing import CameraInfo
from mocapd.capture.webcam.webcams import SYSFS
from mocapd.errors import Problem
from mocapd.wizard.draft import DraftCamera


def node_of(camera: DraftCamera, nodes: Sequence[CameraInfo]) -> CameraInfo | None:
    """The node of a camera; None for another kind of source, or an unplugged webcam."""
    for one in nodes:
        if one.captures and camera.source in (one.spec, str(one.node)):
            return one
    wanted = identity_of(camera.source)
    if wanted is None:
        return None
    moved = [
        node
        for node in nodes
        if node.captures and node.identity and node.identity.model == wanted.model
    ]
    return moved[0] if len(moved) == 1 else None


def unused_nodes(
    cameras: Sequence[DraftCamera], nodes: Sequence[CameraInfo]
) -> tuple[CameraInfo, ...]:
    """The cameras of the machine that the setup has not opened, with their reasons."""
    used = [node_of(camera, nodes) for camera in cameras]
    return tuple(node for node in nodes if node.captures and node not in used)


def mode_of(camera: DraftCamera, node: CameraInfo) -> Mode:
    """The requested mode of a camera: MJPG where available."""
    mjpg = any(fmt.fourcc == "MJPG" for fmt in node.formats)
    return Mode("MJPG" if mjpg else "YUYV", camera.size_px, camera.fps_hz)


def offers(
    cameras: Sequence[DraftCamera],
    nodes: Sequence[CameraInfo],
    statuses: Mapping[str, CaptureStatus],
) -> tuple[dict[str, Mode], tuple[Problem, ...]]:
    """For cameras on a crowded USB bus: by id a mode that fits, and the problem.

    A camera that has run for a while at its rate disproves an estimate, so buses where all cameras do are left out.
    """
    on_usb = {}
    formats = {}
    for camera in cameras:
        node = node_of(camera, nodes)
        if node is not None and node.identity is not None and node.formats:
            on_usb[camera.id] = (node.identity.port_path, mode_of(camera, node))
            formats[camera.id] = node.formats
    modes: dict[str, Mode] = {}
    problems = []
    for bus in crowded_buses(on_usb, SYSFS):
        if all(_runs(statuses.get(name), on_usb[name][1].fps_hz) for name in bus.cameras):
            continue
        budget = bus.usable_bytes_per_s / len(bus.cameras)
        for name in bus.cameras:
            asked = on_usb[name][1]
            if asked.bytes_per_s > budget:
                lower = lower_mode(formats[name], asked, budget)
                if lower is not None:
                    modes[name] = lower
        problems.append(
            Problem(
                f"USB bus {bus.bus} cannot carry {' and '.join(bus.cameras)} together: they ask "
                f"for {bus.asked_bytes_per_s / 1e6:.0f} MB/s, it has about "
                f"{bus.usable_bytes_per_s / 1e6:.0f}",
                ", ".join(bus.cameras),
                "plug one into a port of another USB controller"
                + (", or take the lower mode that is offered" if modes else ""),
            )
        )
    return modes, tuple(problems)


def _runs(status: CaptureStatus | None, fps_hz: float) -> bool:
    return (
        status is not None and status.state is CaptureState.LIVE and status.fps_hz >= 0.8 * fps_hz
    )
