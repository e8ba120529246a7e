"""Looks at each two cameras until it is known whether they have changed places, and again while they have."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

from mocapd.calibrate.bump.changed_places import Places, PlacesParams, places_of
from mocapd.clock import nanoseconds
from mocapd.types import Camera, Frame

_AGAIN_S = 10.0  # from one look at two cameras to the next: it takes a fifth of a second
_LOOKS = 6  # at two that tell nothing: there is too little that both see


@dataclass(slots=True, eq=False)
class _TwoCameras:
    """What is known of two cameras, how often they were looked at, and when they may be again."""

    cameras: tuple[Camera, Camera]
    places: Places = Places.UNKNOWN
    looks: int = 0
    next_ns: int = 0


class PlacesWatch:
    """Shown the newest pictures now and then; tells which cameras have changed places."""

    def __init__(self, cameras: Sequence[Camera], params: PlacesParams | None = None) -> None:
        self._params = params
        self._pairs = [_TwoCameras(pair) for pair in combinations(cameras, 2)]

    def is_swapped(self, camera: str) -> bool:
        """Whether a camera of this name shows what another one should."""
        return any(
            pair.places is Places.CHANGED and camera in (one.name for one in pair.cameras)
            for pair in self._pairs
        )

    def look(self, newest: Mapping[str, Frame]) -> tuple[tuple[str, str], Places] | None:
        """At most two cameras of these pictures, each of its camera's size: what is known of them now and was not before."""
        for pair in self._pairs:
            first, second = (newest.get(one.name) for one in pair.cameras)
            if first is None or second is None or not self._is_due(pair, first.t_ns):
                continue
            pair.looks += 1
            pair.next_ns = first.t_ns + nanoseconds(_AGAIN_S)
            before = pair.places
            now = places_of(pair.cameras, (first.pixels, second.pixels), self._params)
            if now is Places.UNKNOWN or now is before:
                return None
            pair.places = now
            return (pair.cameras[0].name, pair.cameras[1].name), now
        return None

    def _is_due(self, pair: _TwoCameras, t_ns: int) -> bool:
        if t_ns < pair.next_ns or pair.places is Places.RIGHT:
            return False
        return pair.places is Places.CHANGED or pair.looks < _LOOKS
