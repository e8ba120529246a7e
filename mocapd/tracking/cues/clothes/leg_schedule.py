"""When legs and head below a trunk that the shirt carries are fitted, when keypoints are detected for them, and which camera
teaches their look.

Half of what both cues cost together is legs and head, which mostly stand. While they hardly move they go on as predicted in
every second frame set: in 33 ms, what is slower than 0.45 m/s strays by less than its fit does. Not before cameras side by
side, whose toes hang on which points are measured in which frame set (docs/decisions/one-body.md).
"""

import numpy as np

from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import INDEX
from mocapd.fit.fit_params import TICK_S
from mocapd.fit.view import View
from mocapd.types import Floats

_CALM_M_S = 0.45  # knees, ankles and head that are no faster
_JOINTS = [INDEX["head"], *(INDEX[side + bone] for side in SIDES for bone in ("LowerLeg", "Foot"))]
_NEVER = -1000  # a tick long ago


class LegSchedule:
    """Counts in ticks, see `ticks.py`."""

    def __init__(self) -> None:
        self._fitted, self._detected = _NEVER, _NEVER
        self._learned: dict[int, int] = {}  # by camera
        self._places_m, self._is_calm = np.full((len(_JOINTS), 3), np.inf), False

    def rests(self, now: int, every: int) -> bool:
        """Whether no fit is due; every: ticks between two fits of legs that move."""
        every += self._is_calm
        return every > 1 and now - self._fitted < every

    def detects(self, now: int, every_s: float) -> bool:
        """Whether keypoints are due, which are then detected."""
        if now - self._detected < round(every_s / TICK_S):
            return False
        self._detected = now
        return True

    def on_fit(self, joints_m: Floats, now: int, crossing: bool) -> None:
        """Remembers a fit with joints at joints_m (J,3). crossing: of views that cross."""
        places_m, took_s = joints_m[_JOINTS], max(now - self._fitted, 1) * TICK_S
        way_m = np.linalg.norm(places_m - self._places_m, axis=1).max()
        self._is_calm = crossing and bool(way_m < _CALM_M_S * took_s)
        self._places_m, self._fitted = places_m, now

    def turn(self, frame_index: int) -> int:
        """A running number for work that takes turns, of which legs that rest leave none out."""
        return frame_index // 2 if self._is_calm else frame_index

    def teacher(self, views: tuple[View, ...], now: int, every_s: float) -> tuple[View, ...]:
        """The view that teaches the look: one in a frame set, each no more often than every_s; empty if none is due."""
        due = [v for v in views if now - self._when(v) >= round(every_s / TICK_S)]
        if not due:
            return ()
        view = min(due, key=self._when)
        self._learned[view.index] = now
        return (view,)

    def _when(self, view: View) -> int:
        return self._learned.get(view.index, _NEVER)
