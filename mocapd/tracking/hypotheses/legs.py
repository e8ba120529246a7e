"""Two legs look alike: when each has slipped onto the other, they are exchanged, or the hips were left behind in a turn."""

from dataclasses import replace

import numpy as np

from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import INDEX, PARENTS
from mocapd.fit.limbs.mirroring_kernels import shortest_turn
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.geometry import rotations
from mocapd.types import Floats

_OF_HIPS = [INDEX[name] for name in ("spine", "leftUpperLeg", "rightUpperLeg")]
_CROSSED_M = 0.03  # by which the left ankle is to the right of the right one
LEG_BONES = ("UpperLeg", "LowerLeg", "Foot")


def are_crossed(joints_m: Floats) -> bool:
    """Whether the ankles of joints (J,3) lie the other way round than the hip joints, seen from above."""
    across = joints_m[INDEX["leftUpperLeg"]] - joints_m[INDEX["rightUpperLeg"]]
    across[1] = 0.0
    length = float(np.linalg.norm(across))
    ankles = joints_m[INDEX["leftFoot"]] - joints_m[INDEX["rightFoot"]]
    return length > 1e-3 and float(ankles @ across) / length < -_CROSSED_M


def twist_rad(globals_xyzw: Floats) -> float:
    """By how much the chest is turned against the hips, of global rotations (J,4), about the vertical, y."""
    left = np.array([1.0, 0.0, 0.0])
    hips, chest = (
        rotations.rotate(globals_xyzw[INDEX[bone]], left) for bone in ("hips", "upperChest")
    )
    return float(np.angle(np.exp(1j * (_bearing_rad(chest) - _bearing_rad(hips)))))


def with_hips_below_chest(fitter: Fitter, state: MotionState) -> MotionState:
    """The hips turned as the chest is, each leg where it was, or the other one there if that crosses them no more."""
    _, globals_ = fitter.joints(state)
    half = 0.5 * twist_rad(globals_)
    turned = rotations.multiply(
        np.array([0.0, np.sin(half), 0.0, np.cos(half)]), globals_[INDEX["hips"]]
    )
    local = state.local_xyzw.copy()
    local[INDEX["hips"]] = turned
    for bone in _OF_HIPS:
        local[bone] = rotations.multiply(rotations.inverse(turned), globals_[bone])
    out = replace(state, local_xyzw=local, velocity=np.zeros_like(state.velocity))
    return with_legs_exchanged(fitter, out) if are_crossed(fitter.joints(out)[0]) else out


def _bearing_rad(direction: Floats) -> float:
    """Of a direction (3,), about the vertical."""
    return float(np.arctan2(-direction[2], direction[0]))


def with_legs_exchanged(fitter: Fitter, state: MotionState) -> MotionState:
    """Each leg bent as the other one is, and turned so that its ankle is where the other's was."""
    joints_m, globals_ = fitter.joints(state)
    local = state.local_xyzw.copy()
    for side, other in (SIDES, SIDES[::-1]):
        mine, its = ([INDEX[one + bone] for bone in LEG_BONES] for one in (side, other))
        ankle_m = joints_m[its[-1]]
        to_mine = np.empty(4)
        shortest_turn(ankle_m - joints_m[its[0]], ankle_m - joints_m[mine[0]], to_mine)
        turned = rotations.multiply(to_mine, globals_[its])
        parents = np.concatenate([globals_[PARENTS[mine[:1]]], turned[:-1]])
        local[mine] = rotations.multiply(rotations.inverse(parents), turned)
    return replace(state, local_xyzw=local, velocity=np.zeros_like(state.velocity))
