"""Lists the cameras of this machine, with the reason for each unusable one (`mocapd cameras`)."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from mocapd.capture.webcam.device_access import check_usable, opened_node
from mocapd.capture.webcam.identity import WebcamIdentity
from mocapd.capture.webcam.usb_devices import UsbWebcam, usb_webcams
from mocapd.capture.webcam.v4l2_ioctl import PixelFormat, captures_video, enumerate_formats
from mocapd.capture.webcam.webcams import DEV, SYSFS, VideoNode, video_nodes
from mocapd.errors import MocapdError


@dataclass(frozen=True, slots=True)
class CameraInfo:
    """One V4L2 node, or (`node` None) a USB webcam that no driver has taken.

    `spec`: what to write into the config, a `usb:` identity where there is one. `formats`: MJPG
    first. `problem`: why it is unusable, empty otherwise; `fix`: of the problem. `note`: a remark on a
    usable camera. `captures`: False for a metadata node.
    """

    node: Path | None
    name: str
    identity: WebcamIdentity | None
    spec: str
    formats: tuple[PixelFormat, ...]
    problem: str
    fix: str
    note: str = ""
    captures: bool = True

    @property
    def usable(self) -> bool:
        return not self.problem

    @property
    def usb_id(self) -> str:
        """vid:pid:serial, empty off USB."""
        return ":".join(self.identity.model) if self.identity else ""

    @property
    def port_path(self) -> str:
        """The USB port path, empty off USB."""
        return self.identity.port_path if self.identity else ""


def list_cameras(
    sysfs: Path = SYSFS,
    dev: Path = DEV,
    usb: Callable[[], tuple[UsbWebcam, ...]] = usb_webcams,
) -> tuple[CameraInfo, ...]:
    """Every camera of the machine, usable or not; opens the nodes for questions, streams from none."""
    nodes = video_nodes(sysfs, dev)
    taken = {node.identity.port_path for node in nodes if node.identity}
    rows = [_node_info(node) for node in nodes]
    rows += [_without_node(webcam) for webcam in usb() if webcam.identity.port_path not in taken]
    return tuple(_with_twin_note(row, rows) for row in rows)


def _node_info(node: VideoNode) -> CameraInfo:
    spec = str(node.identity) if node.identity and node.index == 0 else str(node.node)
    formats: tuple[PixelFormat, ...] = ()
    problem = fix = note = ""
    captures = node.index == 0 or node.identity is None  # a guess, until the node answers
    try:
        with opened_node(node.node) as fd:
            captures = _captures(fd, captures)
            formats = tuple(
                sorted(enumerate_formats(fd), key=lambda format_: format_.fourcc != "MJPG")
            )
            check_usable(node.node, fd)
        fourccs = {format_.fourcc for format_ in formats}
        if "MJPG" not in fourccs and "YUYV" in fourccs:
            note = "YUYV only, no MJPG: it fills a USB 2 bus; expect low rates and one such camera"
        elif "MJPG" not in fourccs:
            problem = (
                f"delivers neither MJPG nor YUYV, only {', '.join(sorted(fourccs)) or 'nothing'}"
            )
            fix = "use another camera"
    except MocapdError as error:
        problem, fix = error.what, error.fix
    return CameraInfo(
        node.node, node.name, node.identity, spec, formats, problem, fix, note, captures
    )


def _captures(fd: int, guess: bool) -> bool:
    try:
        return captures_video(fd)
    except OSError:  # `check_usable` reports the cause
        return guess


def _without_node(webcam: UsbWebcam) -> CameraInfo:
    return CameraInfo(
        node=None,
        name=webcam.product,
        identity=webcam.identity,
        spec=str(webcam.identity),
        formats=(),
        problem="a USB webcam without a /dev/video node",
        fix="load its driver: sudo modprobe uvcvideo",
    )


def _with_twin_note(row: CameraInfo, rows: list[CameraInfo]) -> CameraInfo:
    """Adds a note to twins: only their sockets distinguish webcams of one vid:pid:serial."""
    ports = {other.port_path for other in rows if row.identity and other.usb_id == row.usb_id}
    if len(ports) < 2 or row.note or row.problem:
        return row
    return replace(row, note="has a twin with the same vid:pid:serial: keep each in its USB port")
