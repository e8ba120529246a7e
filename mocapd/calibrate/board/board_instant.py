"""The board in the cameras' pictures of one instant, and the speed of its corners."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mocapd.calibrate.board.board_detection import BoardView
from mocapd.types import Frame

_REMEMBERED_NS = 700_000_000  # an older view does not give the board's motion
_FRAME_NS = 1e9 / 30.0


@dataclass(frozen=True, slots=True, eq=False)
class BoardObservation:
    """The board in one picture; `motion_px`: of its corners since the last instant [px per 1/30 s], infinite
    where that instant did not show the board."""

    view: BoardView
    t_ns: int
    motion_px: float


@dataclass(frozen=True, slots=True, eq=False)
class BoardInstant:
    """One instant: cameras that had a picture, and the observations of the board."""

    index: int
    t_ns: int
    frames: Mapping[str, Frame]
    observations: Mapping[str, BoardObservation]


def motion_px(before: BoardObservation | None, view: BoardView, t_ns: int) -> float:
    """Of the corners of a view since the one before [px per 1/30 s]; infinite after too long a time."""
    if before is None or not 0 < t_ns - before.t_ns <= _REMEMBERED_NS:
        return float("inf")
    return shift_px(before.view, view) * _FRAME_NS / (t_ns - before.t_ns)


def shift_px(before: BoardView, view: BoardView) -> float:
    """Median shift of the corners that both views have [px]; infinite without such corners."""
    _, then, now = np.intersect1d(before.ids, view.ids, return_indices=True)
    shift = np.linalg.norm(view.corners_px[now] - before.corners_px[then], axis=1)
    return float(np.median(shift)) if len(now) else float("inf")
