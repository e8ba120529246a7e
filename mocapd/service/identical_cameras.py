"""Identical webcams without serial numbers: which of them may take part after they were unplugged together.

Two of one model that were swapped are found as if nothing had happened, each with the other's calibration. So the frames
of those that were away together are held back until each is known by the room that it shows. Where that is not its
own, people are asked.
"""

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from enum import StrEnum

from mocapd.calibrate.bump.landmark_memory import is_other_room, is_own_room
from mocapd.capture.base import Pluggable, Source


class Trust(StrEnum):
    """Whether a webcam is the one that its port says."""

    KNOWN = "known"  # by what it shows, or because nothing speaks against it
    BELIEVED = "believed"  # since the start, though it does not show what it showed before that
    DOUBTED = "doubted"  # it takes no part


@dataclass(slots=True, eq=False)
class _Webcam:
    """One of several alike. losses: how often it went away."""

    group: tuple[str, ...]
    trust: Trust
    is_away: bool = False
    losses: int = 0
    stayed: bool = True  # in its port since the start, as whoever started meant it
    took_part: bool = False
    is_misplaced: bool = False  # by its calibration: where it was before says nothing
    notice: str = ""


class IdenticalCameras:
    """The identical ones among the cameras; every other camera is known. Its owner's lock guards it."""

    def __init__(self, groups: Iterable[Collection[str]], remembered: Collection[str]) -> None:
        """groups: of names that are alike; remembered: names whose room is known from an earlier run."""
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
        """Of all identical ones."""
        return tuple(self._webcams)

    def others(self, camera: str) -> tuple[str, ...]:
        """Those that it may be confused with."""
        webcam = self._webcams.get(camera)
        return tuple(one for one in webcam.group if one != camera) if webcam else ()

    def trust(self, camera: str) -> Trust:
        """As last judged."""
        return self._webcams[camera].trust if camera in self._webcams else Trust.KNOWN

    def losses(self, camera: str) -> int:
        """How often it went away."""
        return self._webcams[camera].losses if camera in self._webcams else 0

    def notice(self, camera: str) -> str:
        """What people must do about it; empty when nothing."""
        return self._webcams[camera].notice if camera in self._webcams else ""

    def admit(self, camera: str) -> bool:
        """A frame of it came; whether it may be used."""
        webcam = self._webcams.get(camera)
        if webcam is None:
            return True
        webcam.is_away = False
        if webcam.trust is Trust.DOUBTED:
            return False
        webcam.took_part = True
        return True

    def misplaced(self, camera: str, is_misplaced: bool) -> None:
        """Whether its picture contradicts its calibration: then its port is none to come back to."""
        if camera in self._webcams:
            self._webcams[camera].is_misplaced = is_misplaced

    def went(self, camera: str) -> None:
        """It was unplugged, or is lost otherwise."""
        webcam = self._webcams.get(camera)
        if webcam is None:
            return
        webcam.is_away = True
        webcam.losses += 1
        group = [self._webcams[name] for name in webcam.group]
        away = [one for one in group if one.is_away]
        if len(away) > 1 and any(one.took_part and not one.is_misplaced for one in group):
            for one in away:
                one.trust, one.stayed = Trust.DOUBTED, False

    def judge(self, camera: str, own: float | None, other: str, likeness: float) -> Trust:
        """Of one that is not known: how much its picture is like its own room, None where nothing is remembered of that, and
        like the room of the likeliest other one."""
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
                f"cannot be told from {of_others}: they are identical, were unplugged together, and none of them saw "
                "before what it sees now; it takes no part -- plug each into the port where it was and start mocapd "
                "anew, which takes your word for it"
            )
        return webcam.trust

    def _is_the_last(self, webcam: _Webcam) -> bool:
        """Whether all others are known again: then there is no choice."""
        others = [
            one for one in (self._webcams[name] for name in webcam.group) if one is not webcam
        ]
        return all(one.trust is Trust.KNOWN and not one.is_away for one in others)


def identical_groups(
    sources: Iterable[Source], calibrated: Collection[str]
) -> list[tuple[str, ...]]:
    """The names of calibrated webcams that have vid, pid and serial in common, of each kind with several."""
    by_model: dict[tuple[str, str, str], set[str]] = {}
    for source in sources:
        if isinstance(source, Pluggable) and source.name in calibrated:
            identity = source.identity
            if identity is not None:
                by_model.setdefault(identity.model, set()).add(source.name)
    return [tuple(sorted(group)) for group in by_model.values() if len(group) > 1]
