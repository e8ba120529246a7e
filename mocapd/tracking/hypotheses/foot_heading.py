"""The foot heading hypothesis: turns a leg about its length until the foot points to its detected toes.

A straight leg looks the same however it is turned about its length. Only the shoe shows the turn, and toe and heel look
alike: a fit finds the nearer of two headings. Ankle and toes triangulated from two cameras or more decide.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import INDEX, PARENTS
from mocapd.fit.limbs.two_bone_ik import LIMBS
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.joint_term import JointTerm
from mocapd.geometry import rotations
from mocapd.tracking.hypotheses.axial_turn import triangulated_between_m, turn_about_rad
from mocapd.tracking.hypotheses.base import HypothesisContext, ScoredFit
from mocapd.tracking.hypotheses.best_start import best_start


@dataclass(frozen=True, slots=True)
class FootHeadingParams:
    """When a leg is turned about its length."""

    away_rad: float = 0.9  # from the triangulated toes
    most_sd_m: float = 0.12  # of ankle and toes: adjacent cameras hardly measure their depth
    shortest_m: float = 0.06  # from ankle to toes, across the leg
    iterations: int = 4
    gain: float = 5.0  # by how much the cost must fall [disagreeing pixels]
    pause_ticks: int = 10  # after a try that failed


class FootHeading:
    """See PoseHypothesis. Remembers when it failed last."""

    def __init__(self, params: FootHeadingParams) -> None:
        self._params = params
        self.reset()

    def reset(self) -> None:
        """See PoseHypothesis."""
        self._next_tick = 0

    def rehearse(self, now: ScoredFit, at: HypothesisContext, /) -> None:
        """See PoseHypothesis: it has no kernels of its own."""

    def test(self, now: ScoredFit, at: HypothesisContext) -> ScoredFit:
        """See PoseHypothesis. Unchanged without detected keypoints."""
        p = self._params
        if at.ticks.last < self._next_tick:
            return now
        for joints in at.joints:
            starts = list(legs_with_turned_feet(at.solvers.fitter, now.fit.state, joints, p))
            if starts:
                better = best_start(now, at, starts, p.iterations, p.gain, farther=0.0)
                if better.fit is now.fit:
                    self._next_tick = at.ticks.last + p.pause_ticks
                now = better
        return now


def legs_with_turned_feet(
    fitter: Fitter, state: MotionState, joints: JointTerm, params: FootHeadingParams
) -> Iterator[tuple[MotionState, tuple[str, ...]]]:
    """For each foot that points away from its triangulated toes: the body with that leg turned about its length, and the
    part that changes."""
    joints_m, globals_xyzw = fitter.joints(state)
    for side in SIDES:
        leg, toes = LIMBS[f"{side}_leg"], INDEX[side + "Toes"]
        detected_m = triangulated_between_m(joints, leg.end, toes, params.most_sd_m)
        along = joints_m[leg.end] - joints_m[leg.upper]
        along /= max(float(np.linalg.norm(along)), 1e-9)
        now_m = joints_m[toes] - joints_m[leg.end]
        turn_rad = turn_about_rad(along, now_m, detected_m, params.shortest_m)
        if abs(turn_rad) <= params.away_rad:
            continue
        turn = rotations.multiply(rotations.exp(turn_rad * along), globals_xyzw[leg.upper])
        local = state.local_xyzw.copy()
        parent = globals_xyzw[PARENTS[leg.upper]]
        local[leg.upper] = rotations.multiply(rotations.inverse(parent), turn)
        yield replace(state, local_xyzw=rotations.canonical(local)), (f"{side}_leg",)
