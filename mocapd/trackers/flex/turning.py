"""Somebody who seems to look away from where the face is: the same silhouette, turned round."""

import numpy as np

from mocapd.body.regions import Label
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fit
from mocapd.geometry import rotations
from mocapd.types import Floats, Ints

_ROUND = np.array([0.0, 1.0, 0.0, 0.0])  # half a turn about the body's own long axis
_HINGES = [INDEX[side + bone] for side in ("left", "right") for bone in ("LowerArm", "LowerLeg")]


def turned_round(state: MotionState) -> MotionState:
    """The state whose body is where this one is and looks the other way: each limb becomes that of the other side.

    Elbows and knees, which bend one way only, are bent as much the other way; a fit makes the limbs meet the picture again.
    """
    other = _other_sides()
    swapped = state.local_xyzw[other]
    local = swapped * np.array([-1.0, 1.0, -1.0, 1.0])  # as seen after the half turn
    local[_HINGES] = swapped[_HINGES] * np.array([1.0, -1.0, -1.0, 1.0])  # mirrored in the body's own plane
    local[0] = rotations.multiply(state.local_xyzw[0], _ROUND)
    return MotionState(
        state.root_m.copy(), local, np.zeros_like(state.velocity), state.factors, state.information
    )


def head_share(fit: Fit) -> float:
    """0..1: how much of the head is seen as it is drawn, face and hair."""
    asked = fit.visible[Label.HEAD] + fit.unexplained[Label.HEAD]
    return float(fit.matched[Label.HEAD] / max(asked, 1.0))


def _other_sides() -> Ints:
    other: Floats = np.arange(N_JOINTS)
    for name, i in INDEX.items():
        for a, b in (("left", "right"), ("right", "left")):
            if name.startswith(a):
                other[i] = INDEX[b + name[len(a) :]]
    return np.asarray(other, np.int64)
