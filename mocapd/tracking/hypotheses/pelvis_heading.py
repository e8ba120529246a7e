"""The pelvis heading hypothesis: turns a pelvis twisted against the trunk to its detected hip joints; trunk and legs stay.

A pelvis looks much the same from all sides. When both legs move fast, as in a squat, a fit can turn it beyond what a spine
can follow, a local minimum. Hip joints triangulated from two cameras or more give its heading.
"""

from dataclasses import dataclass, replace

import numpy as np

from mocapd.body.skeleton import INDEX
from mocapd.fit.limbs.two_bone_ik import LIMBS, two_bone_pose
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.joint_term import JointTerm
from mocapd.geometry import rotations
from mocapd.tracking.hypotheses.axial_turn import triangulated_between_m, turn_about_rad
from mocapd.tracking.hypotheses.base import HypothesisContext, ScoredFit
from mocapd.tracking.hypotheses.keypoint_poses import best_start
from mocapd.types import Floats

_HIPS, _NECK = INDEX["hips"], INDEX["neck"]
_LEFT, _RIGHT = INDEX["leftUpperLeg"], INDEX["rightUpperLeg"]
_SPINE = [INDEX[name] for name in ("spine", "chest", "upperChest")]  # share one bend evenly
_LEGS = [LIMBS["left_leg"], LIMBS["right_leg"]]


@dataclass(frozen=True, slots=True)
class PelvisHeadingParams:
    """When a pelvis is turned."""

    away_rad: float = 0.8  # from the heading of the triangulated hip joints
    most_sd_m: float = 0.12  # standard deviation of each triangulated hip joint
    shortest_m: float = 0.06  # between them, across the trunk
    iterations: int = 4
    gain: float = 5.0  # by how much the cost must fall [disagreeing pixels]


class PelvisHeading:
    """See PoseHypothesis."""

    def __init__(self, params: PelvisHeadingParams) -> None:
        self._params = params

    def reset(self) -> None:
        """See PoseHypothesis."""

    def rehearse(self, now: ScoredFit, at: HypothesisContext, /) -> None:
        """See PoseHypothesis: it has no kernels of its own."""

    def test(self, now: ScoredFit, at: HypothesisContext) -> ScoredFit:
        """See PoseHypothesis. Unchanged if the shirt places the trunk, and without detected keypoints."""
        p = self._params
        if at.trunk_prior is not None:
            return now
        for joints in at.joints:
            start = turned_pelvis(at.solvers.fitter, now.fit.state, joints, p)
            if start is not None:
                starts = [(start, ("left_leg", "right_leg"))]
                now = best_start(now, at, joints, starts, p.iterations, p.gain, farther=0.0)
        return now


def turned_pelvis(
    fitter: Fitter, state: MotionState, joints: JointTerm, params: PelvisHeadingParams
) -> MotionState | None:
    """The body with its pelvis turned about the trunk to its triangulated hip joints, and trunk, knees and feet in place;
    None if these are too uncertain or the pelvis agrees with them."""
    joints_m, globals_xyzw = fitter.joints(state)
    trunk = joints_m[_NECK] - joints_m[_HIPS]
    trunk /= max(float(np.linalg.norm(trunk)), 1e-9)
    detected_m = triangulated_between_m(joints, _RIGHT, _LEFT, params.most_sd_m)
    turn_rad = turn_about_rad(
        trunk, joints_m[_LEFT] - joints_m[_RIGHT], detected_m, params.shortest_m
    )
    if abs(turn_rad) <= params.away_rad:
        return None
    local = state.local_xyzw.copy()
    pelvis = rotations.multiply(rotations.exp(turn_rad * trunk), globals_xyzw[_HIPS])
    bend = rotations.multiply(rotations.inverse(pelvis), globals_xyzw[_SPINE[-1]])
    local[_HIPS] = pelvis
    local[_SPINE] = rotations.exp(rotations.log(rotations.canonical(bend)) / len(_SPINE))
    return _with_legs_at(fitter, replace(state, local_xyzw=local), joints_m, globals_xyzw)


def _with_legs_at(
    fitter: Fitter, state: MotionState, joints_m: Floats, globals_xyzw: Floats
) -> MotionState:
    """The body with knees and ankles towards where they are in joints_m (J,3), and feet turned as in globals_xyzw (J,4)."""
    here_m, here_xyzw = fitter.joints(state)
    local = state.local_xyzw.copy()
    for leg in _LEGS:
        bent = two_bone_pose(leg, fitter.model.rest_m, here_m, here_xyzw, joints_m)
        if bent is not None:
            local[[leg.upper, leg.lower]] = bent
    state = replace(state, local_xyzw=rotations.canonical(local))
    _, here_xyzw = fitter.joints(state)
    for leg in _LEGS:
        shank = rotations.inverse(here_xyzw[leg.lower])
        local[leg.end] = rotations.multiply(shank, globals_xyzw[leg.end])
    return replace(state, local_xyzw=rotations.canonical(local))
