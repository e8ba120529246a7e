"""How a board moves between frames: what cameras that do not expose at the same instant see of it."""

from collections.abc import Sequence

import numpy as np

from mocapd.calibrate.extrinsics.board_reprojection import ReprojectionProblem
from mocapd.geometry import rotations
from mocapd.types import Floats


def board_paths(scene: ReprojectionProblem, indices: Sequence[int]) -> Floats:
    """(V,2,6): velocity [per frame] and half the acceleration [per frame^2] of turn [rad] and shift [m].

    The parabola through the positions one frame before and after; where one of them is unknown the
    board is taken to stand still, and a delay shows nothing there.
    """
    out = np.zeros((len(indices), 2, 6))
    place = {index: v for v, index in enumerate(indices)}
    for v, index in enumerate(indices):
        before, after = place.get(index - 1), place.get(index + 1)
        if before is None or after is None:
            continue
        back, on = _step(scene, v, before), _step(scene, v, after)
        out[v, 0], out[v, 1] = 0.5 * (on - back), 0.5 * (on + back)
    return out


def _step(scene: ReprojectionProblem, start: int, end: int) -> Floats:
    """Turn [rad] and shift [m] (6,) from one position to the other."""
    before, after = scene.scene_from_board[start], scene.scene_from_board[end]
    turn = after.R @ before.R.T
    shift_m = after.t_m - before.t_m
    return np.concatenate([rotations.log(rotations.from_matrix(turn)), shift_m])
