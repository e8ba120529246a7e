"""When legs and head below a trunk that the shirt carries are fitted, and in which cameras keypoints are detected for them or
their look is learned.

Half of what both cues cost together is legs and head, which mostly stand. While they hardly move they go on as predicted in
every second frame set: in 33 ms, what is slower than 0.45 m/s strays by less than its fit does. Not before cameras side by
side, whose toes hang on which points are measured in which frame set (docs/decisions/tracking-speed.md). Legs that move
rest for one frame set where it waits already, so that the tracker catches up instead of missing the next one.

Cameras take turns with the dear work, so that no frame set takes long.
"""

from collections.abc import Iterable

import numpy as np

from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import INDEX
from mocapd.clock import nanoseconds, seconds
from mocapd.fit.fit_params import TICK_S
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.types import Floats

_CALM_M_S = 0.45  # knees, ankles and head that are no faster
_JOINTS = [INDEX["head"], *(INDEX[side + bone] for side in SIDES for bone in ("LowerLeg", "Foot"))]
_NEVER = -1000  # a tick long ago


class CameraTurns:
    """Work that each camera has done no more often than at an interval; counts in ticks, see `ticks.py`."""

    def __init__(self) -> None:
        self._done: dict[int, int] = {}  # by camera

    def take(self, cameras: Iterable[int], now: int, every_s: float, most: int = 1) -> list[int]:
        """The cameras whose turn it is: at most so many, those first that have waited longest."""
        due = [i for i in cameras if now - self._when(i) >= round(every_s / TICK_S)]
        turn = sorted(due, key=self._when)[:most]
        self._done.update(dict.fromkeys(turn, now))
        return turn

    def _when(self, camera: int) -> int:
        return self._done.get(camera, _NEVER)


class LegSchedule:
    """Counts in ticks. keypoints, look: the cameras' turns at detecting keypoints, and at learning the clothes' look."""

    def __init__(self) -> None:
        self._fitted, self._fitted_ns = _NEVER, 0
        self.keypoints, self.look = CameraTurns(), CameraTurns()
        self._places_m, self._is_calm = np.full((len(_JOINTS), 3), np.inf), False

    def rests(self, now: int, every: int, is_late: bool = False) -> bool:
        """Whether no fit is due; every: ticks between two fits of legs that move; is_late: the frame set of `now` waits."""
        every += self._is_calm or is_late
        return every > 1 and now - self._fitted < every

    def on_fit(self, joints_m: Floats, now: int, t_ns: int, crossing: bool) -> None:
        """Remembers a fit with joints at joints_m (J,3), to a frame set at t_ns. crossing: of views that cross."""
        places_m, took_s = joints_m[_JOINTS], seconds(t_ns - self._fitted_ns)
        way_m = np.linalg.norm(places_m - self._places_m, axis=1).max()
        self._is_calm = crossing and bool(way_m < _CALM_M_S * took_s)
        self._places_m, self._fitted, self._fitted_ns = places_m, now, t_ns

    def turn(self, frame_index: int) -> int:
        """A running number for work that takes turns, of which legs that rest leave none out."""
        return frame_index // 2 if self._is_calm else frame_index


def are_new_legs(t_ns: int, since_ns: int | None, params: ClothesParams) -> bool:
    """True if the legs were found a moment ago, at since_ns; None: not yet."""
    return since_ns is None or t_ns - since_ns <= nanoseconds(params.new_legs_s)
