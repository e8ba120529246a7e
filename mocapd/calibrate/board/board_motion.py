"""The motion of a board between frames, for cameras that do not expose at the same instant."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mocapd.calibrate.extrinsics.board_reprojection import ReprojectionProblem
from mocapd.geometry import rotations
from mocapd.types import Floats

_REACH = 2  # positions to either side


def has_one_neighbour(indices: Sequence[int], longest_gap: float) -> NDArray[np.bool_]:
    """(V,): positions without a neighbour within `longest_gap` [frames] on one of their sides; the estimate of their
    motion is less accurate."""
    order = np.argsort(indices)
    near = np.diff(np.asarray(indices, dtype=float)[order]) <= longest_gap
    out = np.ones(len(order), bool)
    out[order] = ~(np.append(False, near) & np.append(near, False)) if len(order) else out
    return out


def board_paths(scene: ReprojectionProblem, indices: Sequence[int], longest_gap: float) -> Floats:
    """(V,2,6): velocity [per frame] and half the acceleration [per frame^2] of turn [rad] and shift [m].

    Of the polynomial through a position and up to two before and two after it, each within `longest_gap` [frames]
    of the next. A position with fewer than two neighbours counts as still, so it says nothing of a delay.
    """
    out = np.zeros((len(indices), 2, 6))
    order = np.argsort(indices)
    at = np.asarray(indices, dtype=float)[order]
    near = np.diff(at) <= longest_gap
    for row, v in enumerate(order.tolist()):
        first = last = row
        while first > max(0, row - _REACH) and near[first - 1]:
            first -= 1
        while last < min(len(at) - 1, row + _REACH) and near[last]:
            last += 1
        if last - first < 2:
            continue
        others = [k for k in range(first, last + 1) if k != row]
        steps = np.stack([_step(scene, v, int(order[k])) for k in others])
        since = at[others] - at[row]
        powers = since[:, None] ** np.arange(1, len(others) + 1)
        out[v] = np.linalg.solve(powers, steps)[:2]
    return out


def _step(scene: ReprojectionProblem, start: int, end: int) -> Floats:
    """Rotation [rad] and shift [m] (6,) from one position to the other."""
    before, after = scene.scene_from_board[start], scene.scene_from_board[end]
    turn = after.R @ before.R.T
    shift_m = after.t_m - before.t_m
    return np.concatenate([rotations.log(rotations.from_matrix(turn)), shift_m])
