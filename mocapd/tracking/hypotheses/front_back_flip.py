"""The front-back flip hypothesis: an outline hardly shows the facing direction, so faces and flipped fits decide."""

from dataclasses import dataclass, field, replace

import numpy as np

from mocapd.fit.fit_result import Fit
from mocapd.geometry.camera_model import centre
from mocapd.tracking.cues.face.face_orientation import FaceOrientation, FaceOrientationParams
from mocapd.tracking.hypotheses.base import WHOLE, HypothesisContext, ScoredFit
from mocapd.tracking.hypotheses.flip_test import FlipTest, FlipTestParams
from mocapd.tracking.hypotheses.flipped_poses import MIRRORED, UNDER_LIMBS, flipped_poses
from mocapd.vision.face.lbp_cascade_kernels import CascadeArrays

_LOOSE_S = 0.4  # a body that is turned round is held as loosely as a prediction over this time


@dataclass(frozen=True, slots=True)
class FlipParams:
    """most_loss: of what is explained, that a body turned round by its face may cost at first; iterations: of its fit."""

    face: FaceOrientationParams = field(default_factory=FaceOrientationParams)
    flip_test: FlipTestParams = field(default_factory=FlipTestParams)
    most_loss: float = 0.12
    iterations: int = 6


class FrontBackFlip:
    """See PoseHypothesis; skipped while the shirt places the trunk. Accumulates evidence from faces and fits."""

    def __init__(self, params: FlipParams, stature_m: float, cascade: CascadeArrays) -> None:
        """cascade: of frontal faces."""
        self._params = params
        self._flip_test = FlipTest(params.flip_test)
        self._face = FaceOrientation(cascade, stature_m, params.face)

    def reset(self) -> None:
        """See PoseHypothesis."""
        self._face.reset()
        self._flip_test.reset()

    def rehearse(self, _now: ScoredFit, _at: HypothesisContext, /) -> None:
        """See PoseHypothesis."""
        self._face.rehearse()

    def test(self, now: ScoredFit, at: HypothesisContext) -> ScoredFit:
        """See PoseHypothesis."""
        if at.trunk_prior is not None:
            return now
        accepted: Fit | None = None
        self._face.update(at.solvers.fitter, now.fit.state, now.views, at.frames, at.ticks)
        if self._face.is_reversed:
            self._face.reset()
            fits = [self._fit_flipped(now, at, way) for way in (MIRRORED, UNDER_LIMBS)]
            best = min(fits, key=lambda fit: fit.cost)
            if best.explained > now.fit.explained - self._params.most_loss:
                accepted = best
        elif self._flip_test.is_due(at.ticks, now.tried):
            other = self._fit_flipped(now, at, UNDER_LIMBS)
            if self._flip_test.is_better(now.fit, other):
                self._flip_test.reset()
                accepted = other
            self._flip_test.record_test(at.ticks)
        return (
            now if accepted is None else replace(now, fit=accepted, changed=(*now.changed, WHOLE))
        )

    def _fit_flipped(self, now: ScoredFit, at: HypothesisContext, way: int) -> Fit:
        """The body facing the other way, in one of the two ways of `flipped_poses`."""
        fitter = at.solvers.fitter
        eye = np.mean([centre(fitter.drawings[view.index].camera) for view in now.views], axis=0)
        start = flipped_poses(fitter, now.fit.state, now.fit.state.root_m - eye)[way]
        for view in now.views:
            fitter.drawings[view.index].render(start, view.dt_s, view.roi)
        terms = at.evidence.measure(start, now.views)
        return fitter.fit(start, now.views, _LOOSE_S, self._params.iterations, terms=terms)
