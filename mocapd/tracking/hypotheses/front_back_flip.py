"""Which way somebody faces is hard to tell from an outline: the body turned round, by its face or by its fit."""

from dataclasses import dataclass, field, replace

import numpy as np

from mocapd.fit.fit_result import Fit
from mocapd.geometry.camera_model import centre
from mocapd.tracking.cues.face.face_watch import FaceWatch, FaceWatchParams
from mocapd.tracking.hypotheses.base import WHOLE, Judged, Situation
from mocapd.tracking.hypotheses.turn_watch import TurnWatch, TurnWatchParams
from mocapd.tracking.hypotheses.turned_round import MIRRORED, UNDER_LIMBS, turned_round
from mocapd.vision.face.lbp_cascade_kernels import CascadeArrays

_LOOSE_S = 0.4  # a body that is turned round is held as loosely as a prediction over this time


@dataclass(frozen=True, slots=True)
class FlipParams:
    """most_loss: of what is explained, that a body turned round by its face may cost at first; iterations: of its fit."""

    facing: FaceWatchParams = field(default_factory=FaceWatchParams)
    turning: TurnWatchParams = field(default_factory=TurnWatchParams)
    most_loss: float = 0.12
    iterations: int = 6


class FrontBackFlip:
    """Where no trunk leads that knows the way; see PoseHypothesis. Remembers what faces and fits said of the way."""

    def __init__(self, params: FlipParams, stature_m: float, cascade: CascadeArrays) -> None:
        """cascade: of frontal faces."""
        self._params = params
        self._turning = TurnWatch(params.turning)
        self._facing = FaceWatch(cascade, stature_m, params.facing)

    def reset(self) -> None:
        """See PoseHypothesis."""
        self._facing.reset()
        self._turning.reset()

    def rehearse(self, _now: Judged, _at: Situation, /) -> None:
        """See PoseHypothesis."""
        self._facing.rehearse()

    def test(self, now: Judged, at: Situation) -> Judged:
        """See PoseHypothesis."""
        if at.held is not None:
            return now
        found: Fit | None = None
        self._facing.look(at.dressed.fitter, now.fit.state, now.views, at.frames, at.ticks)
        if self._facing.is_turned:
            self._facing.reset()
            fits = [self._fitted(now, at, way) for way in (MIRRORED, UNDER_LIMBS)]
            best = min(fits, key=lambda one: one.cost)
            if best.explained > now.fit.explained - self._params.most_loss:
                found = best
        elif self._turning.is_due(at.ticks, now.tried):
            other = self._fitted(now, at, UNDER_LIMBS)
            if self._turning.is_turned(now.fit, other):
                self._turning.reset()
                found = other
            self._turning.looked(at.ticks)
        return now if found is None else replace(now, fit=found, changed=(*now.changed, WHOLE))

    def _fitted(self, now: Judged, at: Situation, way: int) -> Fit:
        """The body facing the other way, in one of the two ways of `turned_round`."""
        fitter = at.dressed.fitter
        eye = np.mean([centre(fitter.drawings[view.index].camera) for view in now.views], axis=0)
        start = turned_round(fitter, now.fit.state, now.fit.state.root_m - eye)[way]
        for view in now.views:
            fitter.drawings[view.index].render(start, view.dt_s, view.roi)
        terms = at.evidence.measured(start, now.views)
        return fitter.fit(start, now.views, _LOOSE_S, self._params.iterations, terms=terms)
