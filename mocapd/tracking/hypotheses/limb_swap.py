"""The leg swap hypothesis: both legs look alike, so a fit may exchange them, or leave the hips behind in a turn."""

from dataclasses import dataclass, replace

import numpy as np

from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import INDEX, PARENTS
from mocapd.fit.limbs.limb_fits import cheapest_fit
from mocapd.fit.limbs.mirroring_kernels import shortest_turn
from mocapd.fit.motion_state import MotionState
from mocapd.fit.priors.pose_prior import unusual_legs
from mocapd.fit.solver import Fitter
from mocapd.geometry import rotations
from mocapd.tracking.hypotheses.base import HypothesisContext, ScoredFit
from mocapd.types import Floats

_OF_HIPS = [INDEX[name] for name in ("spine", "leftUpperLeg", "rightUpperLeg")]
_CROSSED_M = 0.03  # by which the left ankle is to the right of the right one
LEG_BONES = ("UpperLeg", "LowerLeg", "Foot")


@dataclass(frozen=True, slots=True)
class LimbSwapParams:
    """When legs are exchanged."""

    every_s: float = 3 / 30  # from one look at crossed legs to the next
    looks: int = 5  # in a row: a step sideways crosses them for a moment
    twisted_rad: float = 0.7  # of the chest against the hips, above which these may be left behind
    iterations: int = 4
    gain: float = 10.0  # by how much the cost must fall to exchange them [disagreeing pixels]


class LimbSwap:
    """See PoseHypothesis. Counts the successive tests with crossed legs."""

    def __init__(self, params: LimbSwapParams) -> None:
        self._params = params
        self.reset()

    def reset(self) -> None:
        """See PoseHypothesis."""
        self._crossed_looks = 0

    def rehearse(self, now: ScoredFit, at: HypothesisContext, /) -> None:
        """See PoseHypothesis."""
        with_legs_exchanged(at.solvers.fitter, now.fit.state)

    def test(self, now: ScoredFit, at: HypothesisContext) -> ScoredFit:
        """Tests crossed legs exchanged. Without a trunk from the shirt it also tests the hips turned below the chest: after a
        turn of the body they may have been left behind."""
        p, fitter, fit = self._params, at.solvers.fitter, now.fit
        if not at.ticks.due(p.every_s):
            return now
        hips_too = at.trunk_prior is None
        joints_m, globals_xyzw = fitter.joints(fit.state)
        twisted = hips_too and abs(twist_rad(globals_xyzw)) > p.twisted_rad
        crossed = are_crossed(joints_m)
        self._crossed_looks = self._crossed_looks + 1 if crossed or twisted else 0
        if self._crossed_looks < p.looks:
            return now
        self._crossed_looks = 0
        starts = [with_legs_exchanged(fitter, fit.state)] if crossed else []
        if twisted:
            starts.append(with_hips_below_chest(fitter, fit.state))
        # the pose prior of legs counts only below hips that the shirt confirms
        unusual = 0.0 if hips_too else 1.0
        best = cheapest_fit(
            fit, starts,
            lambda start: fitter.fit(start, now.views, at.dt_s, p.iterations, terms=now.terms),
            lambda one: one.cost + unusual * unusual_legs(one.state.local_xyzw), p.gain,
        )  # fmt: skip
        if best is fit:
            return now
        changed = dict.fromkeys((*now.changed, *(f"{side}_leg" for side in SIDES)))
        return replace(now, fit=best, changed=tuple(changed))


def are_crossed(joints_m: Floats) -> bool:
    """True if the ankles of joints (J,3) are the other way round than the hip joints, in the view from above."""
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
