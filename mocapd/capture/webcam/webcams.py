"""The webcams that are plugged in, from sysfs: USB identity, name and /dev nodes.

sysfs is readable by everybody and answers in under a millisecond, so it is read again at each
reopening. It holds the kernel's copy of the serial, which libusb can only read with write access to
the USB node.
"""

from dataclasses import dataclass
from pathlib import Path

from mocapd.capture.webcam.identity import Match, WebcamIdentity, match_identity
from mocapd.errors import UnavailableError

SYSFS = Path("/sys")
DEV = Path("/dev")


@dataclass(frozen=True, slots=True)
class VideoNode:
    """One V4L2 node. `index` counts the nodes of one interface: a UVC camera's 0 captures, 1 is metadata.

    `interface` is the name of its USB interface, as `1-3:1.0`, or empty; `identity` is None for
    what is not on USB (a loopback device, a laptop's MIPI camera).
    """

    node: Path
    name: str
    index: int
    interface: str
    identity: WebcamIdentity | None


def attribute(path: Path) -> str:
    """The content of a sysfs attribute, empty when it is absent or vanishes with its device."""
    try:
        return path.read_text(encoding="utf-8", errors="replace").strip()
    except OSError:
        return ""


def _usb_device(device: Path) -> tuple[Path, str] | None:
    """The USB device folder above a node's `device`, and the interface's name; None off USB."""
    for folder in (device, *device.parents):
        if (folder / "idVendor").exists():
            below = device.relative_to(folder).parts
            return folder, below[0] if below else ""
    return None


def usb_identity(folder: Path) -> WebcamIdentity:
    """The identity of a USB device. folder: its sysfs folder, named by its port path."""
    return WebcamIdentity(
        port_path=folder.name,
        vid=attribute(folder / "idVendor").lower(),
        pid=attribute(folder / "idProduct").lower(),
        serial=attribute(folder / "serial"),
    )


def video_nodes(sysfs: Path = SYSFS, dev: Path = DEV) -> tuple[VideoNode, ...]:
    """All V4L2 nodes, in the order of their numbers, metadata nodes included."""
    nodes: list[tuple[int, VideoNode]] = []
    for entry in (sysfs / "class" / "video4linux").glob("video*"):
        number = entry.name.removeprefix("video")
        if not number.isdigit():
            continue
        usb = _usb_device((entry / "device").resolve())
        index = attribute(entry / "index")
        node = VideoNode(
            node=dev / entry.name,
            name=attribute(entry / "name"),
            index=int(index) if index.isdigit() else 0,
            interface=usb[1] if usb else "",
            identity=usb_identity(usb[0]) if usb else None,
        )
        nodes.append((int(number), node))
    return tuple(node for _, node in sorted(nodes, key=lambda pair: pair[0]))


def capture_nodes(sysfs: Path = SYSFS, dev: Path = DEV) -> dict[WebcamIdentity, VideoNode]:
    """The node that captures, of each USB webcam: index 0 of its first interface that has nodes."""
    nodes = [node for node in video_nodes(sysfs, dev) if node.identity and node.index == 0]
    first: dict[WebcamIdentity, VideoNode] = {}
    for node in sorted(nodes, key=lambda node: node.interface):
        if node.identity is not None:
            first.setdefault(node.identity, node)
    return first


def find_webcam(
    wanted: WebcamIdentity,
    others: tuple[WebcamIdentity, ...] = (),
    sysfs: Path = SYSFS,
    dev: Path = DEV,
) -> tuple[Match, Path]:
    """Finds a webcam: its match and its /dev node. Raises UnavailableError."""
    nodes = capture_nodes(sysfs, dev)
    match = match_identity(wanted, tuple(nodes), others)
    node = nodes[match.identity].node
    if not node.exists():  # sysfs is a moment ahead of udev
        raise UnavailableError("its node is not made yet", str(node), "wait a moment")
    return match, node
