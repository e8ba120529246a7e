"""Rights, webcams, and whether their USB buses carry them."""

from collections.abc import Iterator, Sequence

from mocapd.capture.kinds.source_kinds import is_settable
from mocapd.capture.webcam.webcam_listing import CameraInfo
from mocapd.control.control_messages import StatusReport
from mocapd.doctor.facts import CameraFacts, UserFacts
from mocapd.doctor.finding import Finding, bad, ok, warn
from mocapd.wizard.cameras.camera_nodes import node_of
from mocapd.wizard.draft import DraftCamera

GROUP = "video"


def check_rights(user: UserFacts, cameras: CameraFacts) -> Iterator[Finding]:
    """Whether this user may open webcams. That a node can be opened goes before any group: who sits at the screen is
    let in by name."""
    told = any("no permission" in one.problem for one in cameras.nodes)
    usable = any(one.usable for one in cameras.nodes)
    if user.is_root or GROUP in user.groups:
        who = "is root" if user.is_root else f"is in the group {GROUP}"
        yield ok("rights", f"{user.name} {who}")
    elif usable and not told:
        yield ok("rights", f"{user.name} may open the webcams without the group {GROUP}")
    elif user.has_video_group:
        yield (bad if told else warn)(
            "rights",
            f"{user.name} is not in the group {GROUP}",
            f"sudo usermod -aG {GROUP} {user.name}, then log in again",
        )
    else:
        yield warn(
            "rights",
            f"this system has no group {GROUP}",
            "ls -l /dev/video* says which group has them",
        )


def check_webcams(facts: CameraFacts, daemons: Sequence[StatusReport]) -> Iterator[Finding]:
    """Each that is plugged in, and each that is wanted and is not."""
    cameras = [one for one in facts.nodes if one.captures]
    for one in cameras:
        yield _webcam(one, _user_of(one, facts.nodes, daemons))
    wanted = [one for one in facts.asked if is_settable(one.source)]
    if not cameras and not wanted:
        yield warn(
            "webcam", "none is plugged in", "plug one in, or see `mocapd demo`; `lsusb` shows it?"
        )
    for camera in wanted:
        if node_of(camera, facts.nodes) is None:
            yield bad(
                "webcam",
                f"{camera.id} ({camera.source}) is not plugged in",
                "plug it in, or `mocapd cameras` and correct its source",
            )


def _webcam(one: CameraInfo, user: str) -> Finding:
    name = f"{one.node or '(no node)'} {one.name}"
    if user:
        return ok("webcam", f"{name}: in use by {user}")
    if one.problem:
        return bad("webcam", f"{name}: {one.problem}", one.fix)
    if one.note:
        return warn("webcam", f"{name}: {one.note}", "see `mocapd cameras`")
    return ok("webcam", name)


def _user_of(node: CameraInfo, nodes: Sequence[CameraInfo], daemons: Sequence[StatusReport]) -> str:
    """The daemon that streams from it; empty when none does."""
    for daemon in daemons:
        for one in daemon.cameras:
            draft = DraftCamera(one.id, one.source, (640, 480), 30.0)
            if one.state == "live" and node_of(draft, nodes) is node:
                return f"the running {daemon.instance}"
    return ""


def check_bandwidth(facts: CameraFacts) -> Iterator[Finding]:
    """Buses that are asked for more than they have, by estimate."""
    for bus in facts.crowded:
        yield warn(
            "usb",
            f"bus {bus.bus} is asked for {bus.asked_bytes_per_s / 1e6:.0f} MB/s by {' and '.join(bus.cameras)},"
            f" it has about {bus.usable_bytes_per_s / 1e6:.0f}",
            "plug one into a port of another USB controller (`lsusb -t`), lower its fps_hz, or, if it asks for more"
            " than it sends: sudo modprobe -r uvcvideo; sudo modprobe uvcvideo quirks=128",
        )
    on_usb = [one for one in facts.asked if node_of(one, facts.nodes) is not None]
    if on_usb and not facts.crowded:
        yield ok("usb", f"its buses carry {' and '.join(one.id for one in on_usb)}")
