"""The same body facing the other way: mirrored in depth, or turned under limbs that stay in place."""

from dataclasses import replace

import numpy as np

from mocapd.body.skeleton import OTHER_SIDE, PARENTS
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.geometry import rotations
from mocapd.types import Floats

_LEFT_TO_RIGHT = np.diag([-1.0, 1.0, 1.0])
_ROUND = np.diag([-1.0, 1.0, -1.0])
MIRRORED, UNDER_LIMBS = 0, 1  # the two of `flipped_poses`


def flipped_poses(
    fitter: Fitter, state: MotionState, along_m: Floats
) -> tuple[MotionState, MotionState]:
    """Two bodies whose outline is about the same along a view (3,), left and right exchanged: mirrored in depth, and turned
    by half a turn under limbs that stay in place."""
    along = along_m * (1.0, 0.0, 1.0)
    along = along / np.linalg.norm(along)
    mirror = np.eye(3) - 2.0 * np.outer(along, along)
    across = rotations.to_matrix(fitter.joints(state)[1])[OTHER_SIDE]
    return (
        _with_rotations(state, mirror @ across @ _LEFT_TO_RIGHT),
        _with_rotations(state, across @ _ROUND),
    )


def _with_rotations(state: MotionState, R: Floats) -> MotionState:
    """The state with these global rotations (J,3,3), at rest."""
    q = rotations.from_matrix(R)
    local = rotations.multiply(rotations.inverse(q[PARENTS]), q)
    local[0] = q[0]  # the hips, which have no parent
    return replace(state, local_xyzw=local, velocity=np.zeros_like(state.velocity))
