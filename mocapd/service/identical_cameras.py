"""Identical webcams without serial numbers: which of them are admitted after they were unplugged together.

Swapped webcams of one model open without an error, each with the other's calibration. So frames of webcams that were
unplugged together are held back until the view of the room identifies each. Where the view contradicts, a notice asks
the user.
"""

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from enum import StrEnum

from mocapd.calibrate.bump.landmark_memory import is_other_room, is_own_room
from mocapd.capture.base import Pluggable, Source


class Trust(StrEnum):
    """Confidence that a webcam is the one of its USB port."""

    KNOWN = "known"  # by its view, or without contrary evidence
    BELIEVED = "believed"  # unmoved since the start, though its view differs from the last run
    DOUBTED = "doubted"  # its frames are dropped


@dataclass(slots=True, eq=False)
class _Webcam:
    """One of several identical webcams. losses: how often it was lost."""

    group: tuple[str, ...]
    trust: Trust
    is_away: bool = False
    losses: int = 0
    stayed: bool = True  # in its port since the start
    took_part: bool = False
    is_misplaced: bool = False  # contradicts its calibration, so its earlier place is no evidence
    notice: str = ""


class IdenticalCameras:
    """State of all identical webcams; every other camera has trust KNOWN. Guarded by the owner's lock."""

    def __init__(self, groups: Iterable[Collection[str]], remembered: Collection[str]) -> None:
        """groups: names of identical webcams; remembered: names with a room memory of an earlier run."""
        self._webcams = {
            name: _Webcam(
                tuple(sorted(group)),
                Trust.DOUBTED if name in remembered else Trust.KNOWN,
            )
            for group in groups
            for name in sorted(group)
        }

    @property
    def names(self) -> tuple[str, ...]:
        """The names of all identical webcams."""
        return tuple(self._webcams)

    def others(self, camera: str) -> tuple[str, ...]:
        """The webcams identical to this one."""
        webcam = self._webcams.get(camera)
        return tuple(name for name in webcam.group if name != camera) if webcam else ()

    def trust(self, camera: str) -> Trust:
        """The last result of `judge`."""
        return self._webcams[camera].trust if camera in self._webcams else Trust.KNOWN

    def losses(self, camera: str) -> int:
        return self._webcams[camera].losses if camera in self._webcams else 0

    def notice(self, camera: str) -> str:
        """The trouble and its fix, for users; empty without trouble."""
        return self._webcams[camera].notice if camera in self._webcams else ""

    def admit(self, camera: str) -> bool:
        """Registers a frame; True if it may be used."""
        webcam = self._webcams.get(camera)
        if webcam is None:
            return True
        webcam.is_away = False
        if webcam.trust is Trust.DOUBTED:
            return False
        webcam.took_part = True
        return True

    def set_misplaced(self, camera: str, is_misplaced: bool) -> None:
        """Sets whether its view contradicts its calibration: its port then identifies nothing."""
        if camera in self._webcams:
            self._webcams[camera].is_misplaced = is_misplaced

    def went(self, camera: str) -> None:
        """Registers a loss, such as unplugging."""
        webcam = self._webcams.get(camera)
        if webcam is None:
            return
        webcam.is_away = True
        webcam.losses += 1
        group = [self._webcams[name] for name in webcam.group]
        away = [member for member in group if member.is_away]
        if len(away) > 1 and any(m.took_part and not m.is_misplaced for m in group):
            for member in away:
                member.trust, member.stayed = Trust.DOUBTED, False

    def judge(self, camera: str, own: float | None, other: str, likeness: float) -> Trust:
        """Identifies a webcam in doubt. own: similarity of its view to its own room, None without a memory of it; likeness:
        to the room of `other`, the most similar other webcam."""
        webcam = self._webcams[camera]
        alike, of_others = " and ".join(webcam.group), " and ".join(self.others(camera))
        if is_own_room(own or 0.0, likeness) or (own is None and self._is_the_last(webcam)):
            webcam.trust, webcam.notice = Trust.KNOWN, ""
        elif is_other_room(own or 0.0, likeness):
            webcam.trust = Trust.DOUBTED
            webcam.notice = (
                f"sees what {other} saw: {alike} are identical, and were swapped; it takes no part -- plug each into the "
                "port where it was"
            )
        elif webcam.stayed:
            webcam.trust = Trust.BELIEVED
            webcam.notice = (
                f"does not see what it saw when mocapd ran last, and is identical to {of_others}: if they were swapped "
                "meanwhile, plug each into the port where it was; if it was moved, calibrate the room again"
            )
        else:
            webcam.trust = Trust.DOUBTED
            webcam.notice = (
                f"cannot be distinguished from {of_others}: they are identical, were unplugged together, and none of them "
                "saw before what it sees now; it takes no part -- plug each into the port where it was and restart mocapd, "
                "which then trusts the ports"
            )
        return webcam.trust

    def _is_the_last(self, webcam: _Webcam) -> bool:
        """True if all other webcams of the group are identified: it must be the remaining one."""
        others = [m for m in (self._webcams[name] for name in webcam.group) if m is not webcam]
        return all(member.trust is Trust.KNOWN and not member.is_away for member in others)


def identical_groups(
    sources: Iterable[Source], calibrated: Collection[str]
) -> list[tuple[str, ...]]:
    """Groups of calibrated webcams, by name, with equal vid, pid and serial."""
    by_model: dict[tuple[str, str, str], set[str]] = {}
    for source in sources:
        if isinstance(source, Pluggable) and source.name in calibrated:
            identity = source.identity
            if identity is not None:
                by_model.setdefault(identity.model, set()).add(source.name)
    return [tuple(sorted(group)) for group in by_model.values() if len(group) > 1]
