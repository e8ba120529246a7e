"""Sightings: instants in which several cameras show the board at rest; the input of the extrinsics."""

from collections.abc import Mapping
from dataclasses import replace
from itertools import combinations

import numpy as np

from mocapd.calibrate.board.board_detection import BoardView
from mocapd.calibrate.board.board_instant import BoardInstant, BoardObservation
from mocapd.calibrate.intrinsics.view_picking import rough_place
from mocapd.types import Floats

Views = Mapping[str, Mapping[int, BoardView]]

# Together these two limit the error of pictures at different times to a third of a pixel.
_MOST_MOTION = 0.0012  # of corners [parts of the picture's width per 1/30 s]
_MOST_SPREAD_S = 0.02  # between the cameras' pictures
_NEW_PLACE = 0.12  # distance from the other sightings of two cameras [picture widths]
_MOST = 16  # of one pair of cameras


class BoardSightings:
    """The board's views by camera and index; views of one index are of one instant."""

    def __init__(self, sizes_px: Mapping[str, tuple[int, int]], board_m: Floats) -> None:
        self._sizes_px, self._board_m = sizes_px, board_m
        self._views: dict[str, dict[int, BoardView]] = {name: {} for name in sizes_px}
        self._places: dict[tuple[str, str], list[Floats]] = {
            pair: [] for pair in combinations(sorted(sizes_px), 2)
        }
        self._new = dict.fromkeys(self._places, 0)  # sightings of each pair from `offer`

    @property
    def views(self) -> Views:
        """By camera and index."""
        return {name: dict(own) for name, own in self._views.items()}

    def common_count(self, a: str, b: str) -> int:
        """The number of sightings by both cameras."""
        return len(self._views[a].keys() & self._views[b].keys())

    @property
    def count(self) -> int:
        """The number of sightings by two cameras or more."""
        indices = [index for own in self._views.values() for index in own]
        return int((np.unique(indices, return_counts=True)[1] >= 2).sum()) if indices else 0

    def largest_group(self, fewest: int) -> set[str]:
        """The largest set of cameras connected by pairs with so many common sightings."""
        groups = [{name} for name in self._views]
        for a, b in self._places:
            if self.common_count(a, b) < fewest:
                continue
            joined = [group for group in groups if a in group or b in group]
            rest = [group for group in groups if a not in group and b not in group]
            groups = [*rest, set().union(*joined)]
        return max(groups, key=len)

    def all_connected(self, fewest: int) -> bool:
        """Whether such pairs connect all cameras."""
        return len(self.largest_group(fewest)) == len(self._views)

    def still(self, name: str, observation: BoardObservation) -> bool:
        """Whether the board is at rest in this camera."""
        return observation.motion_px <= _MOST_MOTION * self._sizes_px[name][0]

    def still_px(self) -> dict[str, float]:
        """By camera the largest motion of a board at rest [px per 1/30 s]."""
        return {name: _MOST_MOTION * size[0] for name, size in self._sizes_px.items()}

    def offer(self, instant: BoardInstant) -> bool:
        """Keep the instant if two cameras show the board at rest at a new place."""
        now = instant.observations
        still = sorted(name for name in now if self.still(name, now[name]))
        times = [now[name].t_ns for name in still]
        if len(still) < 2 or max(times) - min(times) > _MOST_SPREAD_S * 1e9:
            return False
        places = {name: self._place(name, now[name].view) for name in still}
        new = []
        for a, b in combinations(still, 2):
            at_a, at_b = places[a], places[b]
            if at_a is None or at_b is None:
                continue
            place = np.concatenate([at_a, at_b])
            before = self._places[a, b]
            if self._new[a, b] >= _MOST:
                continue
            if not before or np.linalg.norm(before - place, axis=1).min() >= _NEW_PLACE:
                new.append(((a, b), place))
        if not new:
            return False
        for pair, place in new:
            self._places[pair].append(place)
            self._new[pair] += 1
        for name in still:
            self._views[name][instant.index] = now[name].view
        return True

    def add_alone(self, name: str, view: BoardView) -> BoardView:
        """Add a view of a single camera, not simultaneous with others; returns it with an index of its own."""
        # even offsets: never next to another index
        index = view.index + 2 * (1 + sorted(self._sizes_px).index(name))
        alone = replace(view, index=index)
        self._views[name][index] = alone
        return alone

    def add(self, views: Views) -> None:
        """Add views of an earlier step unchanged."""
        for name, own in views.items():
            if name in self._views:
                self._views[name].update(own)
        for a, b in self._places:
            for index in self._views[a].keys() & self._views[b].keys():
                both = [self._place(name, self._views[name][index]) for name in (a, b)]
                self._places[a, b].append(
                    np.concatenate([np.zeros(6) if at is None else at for at in both])
                )

    def _place(self, name: str, view: BoardView) -> Floats | None:
        """(6,): `rough_place`, and the side, as both sides of the board add information at one place."""
        place = rough_place(view, self._board_m, self._sizes_px[name])
        return None if place is None else np.append(place, float(view.back))
