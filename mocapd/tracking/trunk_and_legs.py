"""Combines two fits into one body: trunk and arms of the shirt, legs and head of the clothes."""

from dataclasses import replace

import numpy as np

from mocapd.body.skeleton import INDEX, N_JOINTS, PARENTS
from mocapd.fit.motion_state import MotionState
from mocapd.geometry import rotations
from mocapd.types import Floats

# bones whose rotations the shirt does not observe
LOWER_BONES = np.array(
    [INDEX[name] for name in ("neck", "head")]
    + [INDEX[s + n] for s in ("left", "right") for n in ("UpperLeg", "LowerLeg", "Foot", "Toes")]
)
_FIRST_OF_LOWER = [INDEX[name] for name in ("neck", "leftUpperLeg", "rightUpperLeg")]


def replace_upper_body(whole: MotionState, upper: MotionState) -> MotionState:
    """A whole body with trunk and arms of `upper`; legs and head keep their local rotations."""
    velocity, factors, information = (
        array.copy() for array in (whole.velocity, whole.factors, whole.information)
    )
    n, s = len(upper.velocity), len(upper.factors)
    velocity[:n], factors[:s], information[:s, :s] = (
        upper.velocity,
        upper.factors,
        upper.information,
    )
    return MotionState(upper.root_m, upper.local_xyzw, velocity, factors, information)


def join_bodies(
    below: MotionState, upper: MotionState, line_of_sight: Floats | None = None
) -> MotionState:
    """Trunk and arms of `upper`; legs and neck with the global rotations of `below`, a whole body.

    line_of_sight (3,): a unit vector, along which the body is where `below` is, as the sizes of all its parts say its depth.
    """
    if line_of_sight is not None:
        deeper_m = line_of_sight @ (below.root_m - upper.root_m)
        upper = replace(upper, root_m=upper.root_m + deeper_m * line_of_sight)
    local = upper.local_xyzw.copy()
    local[LOWER_BONES] = below.local_xyzw[LOWER_BONES]
    for joint in _FIRST_OF_LOWER:
        was = _in_world(below.local_xyzw, joint)
        parent = _in_world(upper.local_xyzw, PARENTS[joint])
        local[joint] = rotations.multiply(rotations.inverse(parent), was)
    return replace_upper_body(below, replace(upper, local_xyzw=rotations.canonical(local)))


def freeze_legs(body: MotionState, earlier: MotionState, n_upper: int) -> MotionState:
    """The body with the legs of an earlier state, at rest. n_upper: number of pose parameters of trunk and arms."""
    local, velocity = body.local_xyzw.copy(), body.velocity.copy()
    local[LOWER_BONES], velocity[n_upper:] = earlier.local_xyzw[LOWER_BONES], 0.0
    return replace(body, local_xyzw=local, velocity=velocity)


def with_straight_legs(upper: MotionState, whole: MotionState) -> MotionState:
    """A whole body with this upper body and legs that hang straight down."""
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    free = np.setdiff1d(np.arange(N_JOINTS), LOWER_BONES)
    local[free] = upper.local_xyzw[free]
    return replace_upper_body(whole, replace(upper, local_xyzw=local))


def _in_world(local_xyzw: Floats, joint: int) -> Floats:
    """The global rotation (4,) of a joint."""
    out: Floats = local_xyzw[joint]
    while PARENTS[joint] >= 0:
        joint = int(PARENTS[joint])
        out = rotations.multiply(local_xyzw[joint], out)
    return out
