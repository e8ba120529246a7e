"""Decides which cameras show another one's view. All such decisions are here, from three kinds of evidence.

- Points of the room in both pictures contradict the calibration, and fit it with the cameras exchanged
  (`changed_places.py`): from the first pictures on, without any memory.
- A camera shows the room that another one remembers (`landmark_memory.py`): also where the two have no common view.
  Of different cameras each must show the other's room; of identical ones, which are easily confused, one is enough.
- The views of people (`consistency/`) fit: where the room gives no evidence.

The latest evidence of a pair counts. What people show is compared with the points of the room again, which may take it
back; people take nothing back that the points show.
"""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

from mocapd.calibrate.bump.changed_places import PlacesVerdict, places_of
from mocapd.clock import nanoseconds
from mocapd.types import Camera, Frame

_AGAIN_S = 10.0  # between two comparisons of a pair: each takes a fifth of a second
_LOOKS = 6  # at a pair without matching points: it has too little common view


@dataclass(slots=True, eq=False)
class _Pair:
    """State of two cameras; looks: comparisons of their points; next_ns: time of the next one."""

    cameras: tuple[Camera, Camera]
    places: PlacesVerdict = PlacesVerdict.UNKNOWN
    is_by_people: bool = False  # evidence of people that they changed places
    looks: int = 0
    next_ns: int = 0

    @property
    def names(self) -> tuple[str, str]:
        return self.cameras[0].name, self.cameras[1].name

    def is_due(self, t_ns: int) -> bool:
        if t_ns < self.next_ns or self.places is PlacesVerdict.RIGHT:
            return False
        return self.places is PlacesVerdict.CHANGED or self.looks < _LOOKS


class SwappedCameras:
    """Collects the evidence, and decides which cameras are swapped. One thread gives evidence; any may query."""

    def __init__(self, cameras: Sequence[Camera]) -> None:
        self._pairs = [_Pair(pair) for pair in combinations(cameras, 2)]
        self._shows: dict[str, str] = {}  # by camera, the other one whose room it shows
        self._sure: frozenset[str] = frozenset()  # cameras for which one side is enough
        self._mixed: frozenset[str] = frozenset()  # of groups of more than two, all exchanged

    def misplaced_with(self, camera: str) -> str | None:
        """The camera whose calibration fits this one's pictures, by points or people: its memory is of the wrong
        place."""
        for pair in self._pairs:
            if pair.places is PlacesVerdict.CHANGED and camera in pair.names:
                return pair.names[pair.names[0] == camera]
        return None

    def partner(self, camera: str) -> str | None:
        """The camera whose view this one shows; None when it shows its own, or without evidence."""
        misplaced_with = self.misplaced_with(camera)
        if misplaced_with is not None:
            return misplaced_with
        other = self._shows.get(camera)
        if other is not None and (camera in self._sure or self._shows.get(other) == camera):
            return other
        return None

    def is_swapped(self, camera: str) -> bool:
        """Whether it shows the view of another camera, identified or not."""
        return camera in self._mixed or self.partner(camera) is not None

    def shows_room_of(self, camera: str, other: str | None, is_sure: bool = False) -> None:
        """Evidence of memory: a camera shows the room that another one remembers; None: it does not. is_sure: regardless
        of the other camera's view."""
        if other is None:
            self._shows.pop(camera, None)
            self._sure -= {camera}
        else:
            self._shows[camera] = other
            self._sure = self._sure | {camera} if is_sure else self._sure - {camera}

    def examine_again(self, camera: str) -> None:
        """Reset the evidence of points and people, after the user plugged the camera in again at its place."""
        for pair in self._pairs:
            if camera in pair.names and pair.places is PlacesVerdict.CHANGED:
                pair.places, pair.is_by_people = PlacesVerdict.UNKNOWN, False
                pair.looks = pair.next_ns = 0

    def compare_points(self, newest: Mapping[str, Frame]) -> None:
        """Evidence of the room's points, of one due pair at most; newest: pictures, each of its camera's size."""
        for pair in self._pairs:
            first, second = (newest.get(name) for name in pair.names)
            if first is None or second is None or not pair.is_due(first.t_ns):
                continue
            pair.looks += 1
            pair.next_ns = first.t_ns + nanoseconds(_AGAIN_S)
            places = places_of(pair.cameras, (first.pixels, second.pixels))
            if places is not PlacesVerdict.UNKNOWN:
                pair.places, pair.is_by_people = places, False
            return

    def take_views(self, exchanged: Iterable[Collection[str]]) -> None:
        """Evidence of people: all groups of cameras that a comparison of views found exchanged. It counts until the points
        say otherwise, also against what they said before: the cameras may have changed places since."""
        groups = [set(names) for names in exchanged]
        for pair in self._pairs:
            if set(pair.names) in groups:
                pair.is_by_people |= pair.places is not PlacesVerdict.CHANGED
                pair.places = PlacesVerdict.CHANGED
            elif pair.is_by_people:
                pair.places, pair.is_by_people = PlacesVerdict.UNKNOWN, False
        self._mixed = frozenset(name for group in groups if len(group) > 2 for name in group)
