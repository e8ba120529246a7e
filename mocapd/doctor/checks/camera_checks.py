"""Checks of permissions, webcams, and USB bandwidth."""

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
    """Checks that this user may open webcams. An openable node overrides the group: a user at the console has access by
    an ACL."""
    is_refused = any("no permission" in node.problem for node in cameras.nodes)
    usable = any(node.usable for node in cameras.nodes)
    if user.is_root or GROUP in user.groups:
        reason = "is root" if user.is_root else f"is in the group {GROUP}"
        yield ok("rights", f"{user.name} {reason}")
    elif usable and not is_refused:
        yield ok("rights", f"{user.name} may open the webcams without the group {GROUP}")
    elif user.has_video_group:
        yield (bad if is_refused else warn)(
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
    """Checks each plugged webcam, and reports configured ones that are absent."""
    cameras = [node for node in facts.nodes if node.captures]
    for camera in cameras:
        yield _webcam(camera, _user_of(camera, facts.nodes, daemons))
    wanted = [draft for draft in facts.asked if is_settable(draft.source)]
    if not cameras and not wanted:
        yield warn(
            "webcam", "none is plugged in", "plug one in, or see `mocapd demo`; `lsusb` shows it?"
        )
    for draft in wanted:
        if node_of(draft, facts.nodes) is None:
            yield bad(
                "webcam",
                f"{draft.id} ({draft.source}) is not plugged in",
                "plug it in, or `mocapd cameras` and correct its source",
            )


def _webcam(webcam: CameraInfo, user: str) -> Finding:
    name = f"{webcam.node or '(no node)'} {webcam.name}"
    if user:
        return ok("webcam", f"{name}: in use by {user}")
    if webcam.problem:
        return bad("webcam", f"{name}: {webcam.problem}", webcam.fix)
    if webcam.note:
        return warn("webcam", f"{name}: {webcam.note}", "see `mocapd cameras`")
    return ok("webcam", name)


def _user_of(node: CameraInfo, nodes: Sequence[CameraInfo], daemons: Sequence[StatusReport]) -> str:
    """The daemon that streams from a node; empty without one."""
    for daemon in daemons:
        for camera in daemon.cameras:
            draft = DraftCamera(camera.id, camera.source, (640, 480), 30.0)
            if camera.state == "live" and node_of(draft, nodes) is node:
                return f"the running {daemon.instance}"
    return ""


def check_bandwidth(facts: CameraFacts) -> Iterator[Finding]:
    """Checks the estimated load of the USB buses."""
    for bus in facts.crowded:
        yield warn(
            "usb",
            f"bus {bus.bus} is asked for {bus.asked_bytes_per_s / 1e6:.0f} MB/s by {' and '.join(bus.cameras)},"
            f" it has about {bus.usable_bytes_per_s / 1e6:.0f}",
            "plug one into a port of another USB controller (`lsusb -t`), lower its fps_hz, or, if it asks for more"
            " than it sends: sudo modprobe -r uvcvideo; sudo modprobe uvcvideo quirks=128",
        )
    on_usb = [draft for draft in facts.asked if node_of(draft, facts.nodes) is not None]
    if on_usb and not facts.crowded:
        yield ok("usb", f"its buses carry {' and '.join(draft.id for draft in on_usb)}")
