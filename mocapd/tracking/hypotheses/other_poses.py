"""Poses out of the fit's reach that pictures bear better: another arm or leg, a body turned round, legs exchanged."""

from collections.abc import Sequence

import numpy as np

from mocapd.body.pose_space import SIDES
from mocapd.fit.fit_result import Fit
from mocapd.fit.limbs.arm_search import is_uncertain
from mocapd.fit.limbs.limb_fits import cheapest_fit
from mocapd.fit.motion_state import MotionState
from mocapd.fit.pose_prior import unusual_legs
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.joint_term import JointTerm
from mocapd.fit.terms.term import Term
from mocapd.fit.view import View
from mocapd.geometry.camera_model import centre
from mocapd.tracking.base import Probe
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.tracking.cues.clothes.look import Dressed
from mocapd.tracking.cues.face.face_watch import FaceWatch
from mocapd.tracking.hypotheses.legs import (
    are_crossed,
    twist_rad,
    with_hips_below_chest,
    with_legs_exchanged,
)
from mocapd.tracking.hypotheses.seen_pose import WHOLE, seen_pose
from mocapd.tracking.hypotheses.seen_tries import Anew, Judged, tried_as_seen
from mocapd.tracking.hypotheses.turn_watch import TurnWatch
from mocapd.tracking.hypotheses.turned import MIRRORED, UNDER_LIMBS, turned_round
from mocapd.tracking.ticks import Ticks
from mocapd.types import Floats, FrameSet
from mocapd.vision.face.lbp_cascade_kernels import CascadeArrays

_TURNS_S = 0.4  # a body that is turned round is held as loosely as a prediction over this time

Terms = Sequence[Term]


class OtherPoses:
    """What tells that the pose is wrong, from frame to frame: where the face looks, for how long legs were crossed."""

    def __init__(self, params: ClothesParams, stature_m: float, cascade: CascadeArrays) -> None:
        """cascade: of frontal faces."""
        self._params = params
        self._turning = TurnWatch(params.turning)
        self._facing = FaceWatch(cascade, stature_m, params.facing)
        self.reset()

    def reset(self) -> None:
        """Nothing was seen of anybody."""
        self._facing.reset()
        self._crossed_looks = 0
        self._turning.reset()

    def rehearse(
        self,
        dressed: Dressed,
        state: MotionState,
        views: Sequence[View],
        seen: Sequence[JointTerm],
    ) -> None:
        """Do everything once for nothing: what ordinary frames do not reach must not wait for its kernels."""
        for one in seen:
            seen_pose(dressed.fitter, state, one, (), self._params.seen_pose)
        dressed.arms.rehearse(state, views)
        dressed.legs.rehearse(state, views)
        with_legs_exchanged(dressed.fitter, state)
        self._facing.rehearse()

    def improve(
        self,
        dressed: Dressed,
        fit: Fit,
        views: Sequence[View],
        dt_s: float,
        frames: FrameSet,
        ticks: Ticks,
        searches: bool,
        terms: Terms,
        seen: Sequence[JointTerm],
        anew: Anew,
        probe: Probe,
    ) -> tuple[Fit, list[View], tuple[str, ...]]:
        """The fit, or a better one, its views, and the parts of the body that changed over.

        ticks: that passed; searches: whether others are tried than where joints were seen; terms: of the fit; seen: those
        of them that saw joints; anew: for other poses.
        """
        found = self._as_seen(dressed.fitter, Judged(fit, views, terms), dt_s, seen, anew, None)
        fit, views, terms = found.fit, found.views, found.terms
        probe("seen")
        if not searches:
            return fit, list(views), found.changed
        is_long = found.tried or any(is_uncertain(one, fit, self._params.limbs) for one in SIDES)
        fit, arms = dressed.arms.improve(fit, views, dt_s, ticks.turn, terms)
        changed = [*found.changed, *(f"{side}_arm" for side in arms)]
        probe("arms")
        self._facing.look(dressed.fitter, fit.state, views, frames, ticks)
        if self._facing.is_turned:
            self._facing.reset()
            round_ = self._turned(dressed.fitter, fit, views, anew)
            if round_ is not None:
                fit = round_
                changed.append(WHOLE)
        elif self._turning.is_due(ticks, is_long):
            other = self._fitted_turned(dressed.fitter, fit, views, anew, UNDER_LIMBS)
            if self._turning.is_turned(fit, other):
                self._turning.reset()
                fit = other
                changed.append(WHOLE)
            self._turning.looked(ticks)
        probe("face")
        fit, legs = self._searched_legs(dressed, fit, views, dt_s, ticks, terms, None)
        probe("legs")
        return fit, list(views), (*changed, *legs)

    def other_legs(
        self,
        dressed: Dressed,
        fit: Fit,
        views: Sequence[View],
        dt_s: float,
        ticks: Ticks,
        searches: bool,
        terms: Terms,
        seen: Sequence[JointTerm],
        anew: Anew,
        motion: Floats,
    ) -> tuple[Fit, list[View], tuple[str, ...]]:
        """As `improve`, of the legs alone; motion: of every fit, where an upper body leads."""
        found = self._as_seen(dressed.fitter, Judged(fit, views, terms), dt_s, seen, anew, motion)
        if not searches:
            return found.fit, list(found.views), found.changed
        fit, legs = self._searched_legs(
            dressed, found.fit, found.views, dt_s, ticks, found.terms, motion
        )
        return fit, list(found.views), (*found.changed, *legs)

    def _as_seen(
        self,
        fitter: Fitter,
        now: Judged,
        dt_s: float,
        seen: Sequence[JointTerm],
        anew: Anew,
        motion: Floats | None,
    ) -> Judged:
        """See `tried_as_seen`; as it is in frames that saw no joints."""
        for joints in seen:
            now = tried_as_seen(fitter, now, dt_s, joints, anew, self._params.seen_pose, motion)
        return now

    def _searched_legs(
        self,
        dressed: Dressed,
        fit: Fit,
        views: Sequence[View],
        dt_s: float,
        ticks: Ticks,
        terms: Terms,
        motion: Floats | None,
    ) -> tuple[Fit, tuple[str, ...]]:
        """The fit, or one with other legs, and those that changed over."""
        fit, legs = dressed.legs.improve(fit, views, dt_s, ticks.turn, terms, motion)
        hips_too = motion is None
        apart = self._legs_apart(dressed.fitter, fit, views, dt_s, ticks, terms, hips_too)
        return apart, tuple(f"{side}_leg" for side in (legs if apart is fit else SIDES))

    def _legs_apart(
        self,
        fitter: Fitter,
        fit: Fit,
        views: Sequence[View],
        dt_s: float,
        ticks: Ticks,
        terms: Terms,
        hips_too: bool,
    ) -> Fit:
        """The fit, or that with the legs exchanged: both look alike, and crossed ones are unusual. hips_too: or with the hips
        turned as the chest is, as those of somebody who turned back may be left behind."""
        p = self._params
        if not ticks.due(p.crossed_s):
            return fit
        joints_m, globals_xyzw = fitter.joints(fit.state)
        twisted = hips_too and abs(twist_rad(globals_xyzw)) > p.twisted_rad
        crossed = are_crossed(joints_m)
        self._crossed_looks = self._crossed_looks + 1 if crossed or twisted else 0
        if self._crossed_looks < p.crossed_looks:
            return fit
        self._crossed_looks = 0
        starts = [with_legs_exchanged(fitter, fit.state)] if crossed else []
        if twisted:
            starts.append(with_hips_below_chest(fitter, fit.state))
        # below hips that may be wrong no leg is usual; below those that another tracker knows that counts, too
        unusual = 0.0 if hips_too else 1.0
        return cheapest_fit(
            fit, starts,
            lambda start: fitter.fit(start, views, dt_s, p.crossed_iterations, terms=terms),
            lambda one: one.cost + unusual * unusual_legs(one.state.local_xyzw), p.crossed_gain,
        )  # fmt: skip

    def _turned(
        self,
        fitter: Fitter,
        fit: Fit,
        views: Sequence[View],
        anew: Anew,
    ) -> Fit | None:
        """The body facing the other way, if the pictures bear it."""
        fits = [
            self._fitted_turned(fitter, fit, views, anew, way) for way in (MIRRORED, UNDER_LIMBS)
        ]
        best = min(fits, key=lambda one: one.cost)
        return best if best.explained > fit.explained - self._params.turned_loss else None

    def _fitted_turned(
        self,
        fitter: Fitter,
        fit: Fit,
        views: Sequence[View],
        anew: Anew,
        way: int,
    ) -> Fit:
        """The body facing the other way, in one of the two ways of `turned_round`."""
        eye = np.mean([centre(fitter.drawings[view.index].camera) for view in views], axis=0)
        start = turned_round(fitter, fit.state, fit.state.root_m - eye)[way]
        for view in views:
            fitter.drawings[view.index].render(start, view.dt_s, view.roi)
        iterations, terms = self._params.start.iterations, anew.measured(start, views)
        return fitter.fit(start, views, _TURNS_S, iterations, terms=terms)
