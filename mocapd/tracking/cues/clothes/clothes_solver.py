"""Fits the body to the regions of its clothes: the whole body, or legs and head below a trunk from the shirt."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mocapd.body.model import build_model
from mocapd.body.pose_space import SIDES, full_body, upper_body
from mocapd.body.skeleton import INDEX
from mocapd.each import Each, in_turn
from mocapd.fit.fit_params import TICK_S
from mocapd.fit.fit_result import Fit
from mocapd.fit.joint_uncertainty import joint_uncertainty_m, pose_covariance
from mocapd.fit.motion_state import MotionState, initial_information
from mocapd.fit.priors.motion_prior import predicted_information, prediction_prior
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.floor_term import PlantedTerm
from mocapd.fit.terms.joint_term import JointTerm
from mocapd.fit.terms.term import Term
from mocapd.fit.view import View
from mocapd.fit.work_size import image_scales
from mocapd.tracking.base import Probe
from mocapd.tracking.cues.clothes.camera_views import CameraViews
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.tracking.cues.clothes.confirmed_arms import confirmed_arms
from mocapd.tracking.cues.clothes.first_legs import FirstLegs
from mocapd.tracking.cues.clothes.pose_terms import PoseTerms
from mocapd.tracking.cues.clothes.region_merge import RegionSolverCache
from mocapd.tracking.cues.clothes.regions import Region, silhouette_labels
from mocapd.tracking.cues.clothes.wearer_appearance import WearerAppearance
from mocapd.tracking.cues.keypoints.keypoint_consensus import agreed_keypoints
from mocapd.tracking.cues.keypoints.keypoint_detection import no_detection
from mocapd.tracking.cues.stereo.stereo_distances import add_stereo_depth
from mocapd.tracking.effort import OptionalWork
from mocapd.tracking.hypotheses.base import WHOLE, HypothesisContext, PoseEvidence, ScoredFit
from mocapd.tracking.hypotheses.hypothesis_tests import HypothesisTests
from mocapd.tracking.pictures import Pictures
from mocapd.tracking.planted_feet import PlantedFeet
from mocapd.tracking.ticks import Ticks
from mocapd.tracking.track_state import (
    NEW_BODY_PRIOR_S,
    BodyShapeEstimate,
    TrackState,
    t_pose_state,
)
from mocapd.tracking.velocity import velocity_between
from mocapd.types import Floats, Rig

# their stereo distances are measured below a trunk that the shirt places
_LOWER_REGIONS = (Region.LEG, Region.FOOT)


@dataclass(frozen=True, slots=True, eq=False)
class ClothesObservation:
    """A frame set classified about the predicted body, which is rendered into every view; joints: detected keypoints."""

    drawn: MotionState
    views: list[View]
    joints: tuple[JointTerm, ...]


@dataclass(frozen=True, slots=True, eq=False)
class ClothesEstimate:
    """A whole body fitted to the clothes; cameras: those that show it; changed: parts found away from their prediction;
    off_keypoints_m (J,): of the joints from their keypoints [m], None in a frame set without these;
    line_of_sight (3,): of the only camera, along which legs and head moved the trunk of the shirt."""

    fit: Fit
    motion: MotionState
    views: tuple[View, ...]
    cameras: tuple[str, ...]
    changed: tuple[str, ...] = ()
    off_keypoints_m: Floats | None = None
    line_of_sight: Floats | None = None


class ClothesSolver:
    """Fits a body to the regions of its clothes. Keeps the appearance model, planted feet and hypothesis state."""

    def __init__(
        self,
        rig: Rig,
        stature_m: float,
        params: ClothesParams,
        each: Each = in_turn,
    ) -> None:
        self.params = p = params
        self._rig = rig
        self.model = model = build_model(stature_m, full_body())
        scales = image_scales(rig.cameras, p.fit.work_width_px)
        solvers = RegionSolverCache(model, rig.cameras, scales, p.fit, p.limbs, p.legs, each)
        self.appearance = WearerAppearance(solvers, p)
        self.silhouettes = Fitter(model, silhouette_labels(model), rig.cameras, scales, p.fit, each)
        self.terms = PoseTerms(self.model, len(rig.cameras), p)
        self.cameras = CameraViews(self.fitter, p)
        self._first_legs = FirstLegs(self.silhouettes, self.terms, self.appearance, self.cameras, p)
        self._hypotheses = HypothesisTests(p)
        self._feet = PlantedFeet(self.model.rest_m, p.feet)
        self.work = OptionalWork()

    def searches_everywhere(self, ticks: Ticks) -> bool:
        """True if this frame set updates the foreground of whole pictures, not only about the body."""
        return ticks.due(self.params.uncovered_s * self.work.ghosts)

    def _tests_hypotheses(self, ticks: Ticks) -> bool:
        """Whether other poses are tried in this frame."""
        return ticks.due(self.work.hypotheses * TICK_S)

    @property
    def fitter(self) -> Fitter:
        """Of the wearer's present look."""
        return self.appearance.fitter

    def reset(self) -> None:
        """Forget background and look."""
        self.cameras.reset()
        self.appearance.forget(self.cameras)
        self._hypotheses.reset()
        self._feet.reset()

    def rehearse(self) -> None:
        """Compiles or loads the kernels that an empty room does not reach. Callers reset what it learns by that."""
        model, cameras = self.model, self.cameras
        wearer = BodyShapeEstimate(np.ones(model.n_shape), initial_information(model.space), 0.0)
        body = t_pose_state(model, model.rest_m[0].copy(), wearer)
        black = Pictures(self._rig.cameras, self.params.fit.work_width_px)
        cameras.take({}, dict.fromkeys(range(len(cameras.each)), 0.0))
        cameras.mark_body(body)
        cameras.seed_background()
        cameras.update_foreground()
        self.appearance.learn_first(body, cameras)
        views = cameras.classify(body)
        if not views:
            return  # nobody at the origin is in any picture
        fitter = self.fitter
        views = add_stereo_depth(fitter, body, views, black.grey, self.params.depths)
        if fitter.has_small_baseline(body, views):  # black pictures have no depths
            unseen = np.full(views[0].ids.shape, np.nan, np.float32)
            views[0] = replace(views[0], depth_m=unseen)
        joints = self.terms.joints
        rays = map(joints.detector(fitter, body, cameras), cameras.present)
        found = agreed_keypoints([one for one in rays if one is not None], fitter.joints(body)[0])
        observed = joints.term(model, found)
        feet = np.array([INDEX["leftFoot"]])
        planted = PlantedTerm(model, feet, np.zeros((1, 2)), np.ones(1))
        terms = (*self.terms.measure(fitter, body, views, black.grey, 0), *observed, planted)
        fit = fitter.fit(body, views, TICK_S, 2, terms=terms)
        predicted_information(fit.covariance, body.velocity, 1.0, fitter.prediction_sd, [])
        joint_uncertainty_m(model, *fitter.joints(body), pose_covariance(model, fit.H))
        cameras.learn(body, views)
        self._velocity(fit, views, body, TICK_S, ())
        evidence = PoseEvidence(cameras.classify, lambda _, __: terms)
        at = HypothesisContext(self.appearance.solvers, TICK_S, Ticks(1, 1, 1), observed, evidence)
        self._hypotheses.rehearse(ScoredFit(fit, views, terms), at)

    def fit_whole_body(
        self,
        state: TrackState,
        observed: ClothesObservation,
        dt_s: float,
        pictures: Pictures,
        ticks: Ticks,
        with_depth: bool,
        probe: Probe,
    ) -> ClothesEstimate | None:
        """Fits the whole body, dt_s after `state`; None if too little of it is visible."""
        p, fitter, last = self.params, self.fitter, state.whole
        views, predicted = observed.views, observed.drawn
        if not views:
            return None
        if with_depth:
            views = add_stereo_depth(fitter, predicted, views, pictures.grey, p.depths)
            probe("clothes.depths")
        motion = None
        if last is not None:
            arms = confirmed_arms(fitter, last, predicted, views, p)
            motion = prediction_prior(fitter, last, state.motion.velocity, dt_s, *arms)
        planted = self._planted(pictures.t_ns)

        def terms_of(drawn: MotionState, shown: Sequence[View]) -> tuple[Term, ...]:
            measured = self.terms.measure(fitter, drawn, shown, pictures.grey, ticks.frame_index)
            return (*measured, *observed.joints, *planted)

        terms = terms_of(predicted, views)
        probe("clothes.distances")
        fit = fitter.fit(
            predicted, views, dt_s, p.fit.iterations - self.work.fewer_iterations, rendered=True,
            fine=min(self.work.fine, p.fit.fine_iterations), motion=motion, terms=terms,
        )  # fmt: skip
        probe("clothes.fit")
        at = HypothesisContext(
            self.appearance.solvers, dt_s, ticks, observed.joints,
            PoseEvidence(self.cameras.classify, terms_of), predicted=predicted,
        )  # fmt: skip
        best = self._hypotheses.improve(
            ScoredFit(fit, views, terms), at, self._tests_hypotheses(ticks), probe
        )
        return self._estimate(best, state.motion, dt_s, pictures.t_ns, observed.joints)

    def fit_lower_body(
        self,
        state: TrackState,
        start: MotionState,
        observed: ClothesObservation | None,
        dt_s: float,
        pictures: Pictures,
        ticks: Ticks,
        probe: Probe,
    ) -> ClothesEstimate | None:
        """Fits legs and head of a body whose trunk and arms, in `start`, come from the shirt; dt_s after `state`."""
        p, cameras = self.params, self.cameras
        if cameras.are_new:
            cameras.mark_body(start)
            cameras.seed_background()
        is_new = state.whole is None  # legs that were not observed yet are farther away
        last = None if is_new else state.motion
        iterations = (
            p.start.iterations if is_new else p.guided_iterations - self.work.fewer_iterations
        )
        dt_s = NEW_BODY_PRIOR_S if is_new else dt_s
        ray = self.fitter.line_of_sight(start, cameras.present)
        trunk_prior = self._trunk_prior(state, ray, dt_s)
        if not cameras.has_appearance:
            cameras.mark_body(start)
            cameras.renew_before(self.searches_everywhere(ticks))
            found = self._first_legs.find(start, dt_s, trunk_prior, iterations, is_new, ticks)
            return None if found is None else self._estimate(found, last, dt_s)
        if observed is None:
            views, rays = cameras.prepare(start, self.searches_everywhere(ticks), no_detection)
            observed = ClothesObservation(start, views, self.terms.joints.term(self.model, rays))
        if not observed.views:
            return None
        fitter, planted = self.fitter, self._planted(pictures.t_ns)

        def terms_of(drawn: MotionState, shown: Sequence[View]) -> tuple[Term, ...]:
            measured = self.terms.measure(
                fitter, drawn, shown, pictures.grey, ticks.frame_index, _LOWER_REGIONS
            )
            return (*measured, *observed.joints, *planted)

        terms = terms_of(observed.drawn, observed.views)
        probe("clothes.distances")
        fit = fitter.fit(
            start, observed.views, dt_s, iterations, rendered=observed.drawn is start, fine=1, motion=trunk_prior,
            terms=terms,
        )  # fmt: skip
        probe("clothes.fit")
        at = HypothesisContext(
            self.appearance.solvers, dt_s, ticks, observed.joints,
            PoseEvidence(cameras.classify, terms_of), trunk_prior,
        )  # fmt: skip
        best = self._hypotheses.improve(
            ScoredFit(fit, observed.views, terms), at, self._tests_hypotheses(ticks), probe
        )
        return self._estimate(best, last, dt_s, pictures.t_ns, observed.joints, ray)

    def start_from(
        self, body: MotionState, pictures: Pictures, ticks: Ticks
    ) -> ClothesEstimate | None:
        """Starts from a body of another tracker, if the pictures show its outline; the rest becomes background."""
        cameras = self.cameras
        cameras.mark_body(body)
        if cameras.outline_contrast() < self.params.least_contrast:
            return None
        cameras.seed_background()
        cameras.update_foreground()
        self.appearance.learn_first(body, cameras)
        fitter, views = self.fitter, cameras.classify(body)
        if not views:
            return None
        fit = fitter.fit(
            body, views, NEW_BODY_PRIOR_S, self.params.fit.iterations,
            terms=self.terms.measure(fitter, body, views, pictures.grey, ticks.frame_index),
        )  # fmt: skip
        return self._estimate(ScoredFit(fit, views, ()), None, NEW_BODY_PRIOR_S)

    def _planted(self, t_ns: int) -> tuple[Term, ...]:
        """The term that holds planted feet at t_ns."""
        self._feet.expire(t_ns)
        joints = self._feet.joints
        if not len(joints):
            return ()
        return (PlantedTerm(self.model, joints, self._feet.places_m, self._feet.firmness),)

    def _estimate(
        self,
        scored: ScoredFit,
        last: MotionState | None,
        dt_s: float,
        t_ns: int | None = None,
        keypoints: Sequence[JointTerm] = (),
        ray: Floats | None = None,
    ) -> ClothesEstimate | None:
        fit, changed = scored.fit, scored.changed
        if not _is_plausible(fit, self.params):
            return None
        velocity = np.zeros(self.model.n_pose)
        if last is not None:
            velocity = self._velocity(fit, scored.views, last, dt_s, changed)
        joints_m, _ = self.fitter.joints(fit.state)
        if t_ns is not None:
            sight = self.fitter.common_line_of_sight(fit.state, scored.views)
            self._feet.update(joints_m, t_ns, sight)
        motion, views = replace(fit.state, velocity=velocity), tuple(scored.views)
        off_keypoints_m = keypoints[0].off_keypoints_m(joints_m) if keypoints else None
        return ClothesEstimate(
            fit, motion, views, self.cameras.names(views), changed, off_keypoints_m, ray
        )

    def _velocity(
        self,
        fit: Fit,
        views: Sequence[View],
        last: MotionState,
        dt_s: float,
        changed: Sequence[str],
    ) -> Floats:
        """Velocity (n_pose,) per second since the last state; 0 for relocated parts."""
        of = self.model.space.columns
        columns = [slice(None) if part == WHOLE else of(part) for part in changed]
        confirmed, _ = confirmed_arms(self.fitter, fit, fit.state, views, self.params)
        return velocity_between(self.model, last, fit.state, confirmed, dt_s, columns)

    def _trunk_prior(self, state: TrackState, ray: Floats | None, dt_s: float) -> Floats:
        """Information (n_pose,n_pose) of a prediction whose trunk and arms come from the shirt; ray: the line of sight."""
        p, diagonal = self.params, np.zeros(self.model.n_pose)
        diagonal[:3] = p.guided_sd_m**-2
        diagonal[3 : upper_body().n_pose] = p.guided_sd_rad**-2
        guided = np.diag(diagonal)
        if ray is not None:
            guided[:3, :3] += (p.guided_depth_sd_m**-2 - p.guided_sd_m**-2) * np.outer(ray, ray)
        if state.whole is None:
            frames = max(dt_s / TICK_S, 0.5)
            return guided + np.diag(1.0 / (self.fitter.prediction_sd**2 * frames))
        by_trunk = dict.fromkeys(SIDES, 1.0)  # the arms are where the shirt placed them
        motion = prediction_prior(
            self.fitter, state.whole, state.motion.velocity, dt_s, by_trunk, 1.0
        )
        return np.asarray(motion + guided)


def _is_plausible(fit: Fit, params: ClothesParams) -> bool:
    """True if enough of the body agrees with the pictures."""
    # every second pixel was counted
    enough = 2.0 * fit.matched.sum() >= params.least_body_px
    return fit.explained >= params.live_explained and bool(enough)
