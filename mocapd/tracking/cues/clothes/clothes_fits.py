"""Fits of the body to the regions of its clothes: whole, or legs and head below a trunk that the shirt carries."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mocapd.body.model import BodyModel, build_model
from mocapd.body.pose_space import full_body, upper_body
from mocapd.each import Each, in_turn
from mocapd.fit.fit_params import TICK_S
from mocapd.fit.fit_result import Fit
from mocapd.fit.idmap_renderer import image_scales
from mocapd.fit.motion_state import MotionState, initial_information
from mocapd.fit.priors.motion_prior import predicted_information
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.joint_term import JointTerm
from mocapd.fit.terms.planted_term import PlantedTerm
from mocapd.fit.terms.term import Term
from mocapd.fit.view import View
from mocapd.tracking.base import Probe
from mocapd.tracking.cues.clothes.camera_views import CameraViews
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.tracking.cues.clothes.look import DressedFitters
from mocapd.tracking.cues.clothes.pose_terms import PoseTerms
from mocapd.tracking.cues.clothes.regions import Region, silhouette_labels
from mocapd.tracking.cues.clothes.wardrobe import Wardrobe
from mocapd.tracking.cues.keypoints.joint_views import unwatched
from mocapd.tracking.cues.stereo.depth_views import with_depths
from mocapd.tracking.effort import OptionalWork
from mocapd.tracking.hypotheses.base import WHOLE, Judged, PoseEvidence, Situation
from mocapd.tracking.hypotheses.other_poses import OtherPoses
from mocapd.tracking.planted_feet import PlantedFeet
from mocapd.tracking.prediction_prior import prediction_prior
from mocapd.tracking.ticks import Ticks
from mocapd.tracking.track_state import BEGUN_S, Proportions, TrackState, in_t_pose
from mocapd.tracking.velocity import velocity_between
from mocapd.types import Floats, Frame, FrameSet, Rig
from mocapd.vision.face.lbp_cascade import blind_cascade
from mocapd.vision.face.lbp_cascade_kernels import CascadeArrays

_BELOW = (Region.LEG, Region.FOOT)  # regions whose distances are measured below a carried trunk


@dataclass(frozen=True, slots=True, eq=False)
class Observed:
    """One frame set classified by the body as predicted, which is drawn into every view; joints: what the network saw."""

    drawn: MotionState
    views: list[View]
    joints: tuple[JointTerm, ...]


@dataclass(frozen=True, slots=True, eq=False)
class ClothesFound:
    """A whole body as the clothes place it; cameras: that show it; changed: parts that were found elsewhere."""

    fit: Fit
    motion: MotionState
    views: tuple[View, ...]
    cameras: tuple[str, ...]
    changed: tuple[str, ...] = ()


class ClothesFits:
    """What fits a body to the regions of its clothes. Remembers the wearer's look and what says that a pose is wrong."""

    def __init__(
        self,
        rig: Rig,
        stature_m: float,
        params: ClothesParams,
        cascade: CascadeArrays | None = None,
        each: Each = in_turn,
    ) -> None:
        """cascade: of frontal faces, see `vision.face.lbp_cascade`; None: faces tell nothing."""
        self.params = p = params
        self._rig = rig
        body = build_model(stature_m, full_body())
        smaller = image_scales(rig.cameras, p.fit.work_width_px)
        dressed = DressedFitters(body, rig.cameras, smaller, p.fit, p.limbs, p.legs, each)
        self.wardrobe = Wardrobe(dressed, p)
        self.silhouettes = Fitter(body, silhouette_labels(body), rig.cameras, smaller, p.fit, each)
        self.model = body
        self.terms = PoseTerms(self.model, len(rig.cameras), p)
        self.cameras = CameraViews(self.fitter, p)
        self._others = OtherPoses(p, stature_m, cascade or blind_cascade())
        self._feet = PlantedFeet(self.model.rest_m, p.feet)
        self.work = OptionalWork()

    def looks_round(self, ticks: Ticks) -> bool:
        """Whether all of the pictures are compared with the background in this frame, and not only about the body."""
        return ticks.due(self.params.uncovered_s * self.work.uncovered)

    def _searches(self, ticks: Ticks) -> bool:
        """Whether other poses are tried in this frame."""
        return ticks.due(self.work.other_poses * TICK_S)

    @property
    def fitter(self) -> Fitter:
        """Of the wearer's present look."""
        return self.wardrobe.fitter

    def reset(self) -> None:
        """Forget background and look."""
        self.cameras.reset()
        self.wardrobe.forget(self.cameras)
        self._others.reset()
        self._feet.reset()

    def rehearse(self) -> None:
        """Compile or load the kernels that no frame of an empty room reaches: whoever comes must not wait for them.
        What it has learned by that is to be forgotten."""
        model, cameras = self.model, self.cameras
        wearer = Proportions(np.ones(model.n_shape), initial_information(model.space), 0.0)
        somebody = in_t_pose(model, model.rest_m[0].copy(), wearer)
        black = {
            one.name: Frame(one.name, 0, 0, np.zeros((*one.size_px[::-1], 3), np.uint8))
            for one in self._rig.cameras
        }
        frames = FrameSet(0, black, 0)
        cameras.take({}, dict.fromkeys(range(len(cameras.each)), 0.0))
        cameras.mark_body(somebody)
        cameras.seed_background()
        cameras.update_foreground()
        self.wardrobe.learn_first(somebody, cameras)
        views = cameras.classified(somebody)
        if not views:
            return  # nobody at the origin is in any picture
        fitter = self.fitter
        views = with_depths(fitter, somebody, views, frames, self.params.depths)
        if fitter.has_small_baseline(somebody, views):  # black pictures have no depths
            unseen = np.full(views[0].ids.shape, np.nan, np.float32)
            views[0] = replace(views[0], depth_m=unseen)
        joints = self.terms.joints
        seen = joints.term(model, map(joints.watch(fitter, somebody, cameras), cameras.present))
        terms = (*self.terms.measured(fitter, somebody, views, frames, 0), *seen)
        fit = fitter.fit(somebody, views, TICK_S, 2, terms=terms)
        predicted_information(
            fit.covariance, somebody.velocity, 1.0, fitter.prediction_sd, [], self.params.motion
        )
        cameras.learn(somebody, views)
        _velocity_of(model, self.params, fit, somebody, TICK_S, ())
        evidence = PoseEvidence(cameras.classified, lambda _, __: terms)
        at = Situation(self.wardrobe.dressed, TICK_S, frames, Ticks(1, 1, 1), seen, evidence)
        self._others.rehearse(Judged(fit, views, terms), at)

    def whole(
        self,
        known: TrackState,
        seen: Observed,
        dt_s: float,
        frames: FrameSet,
        ticks: Ticks,
        with_depth: bool,
        probe: Probe,
    ) -> ClothesFound | None:
        """The whole body, dt_s after it was known; None where too little of it is seen."""
        p, fitter, last = self.params, self.fitter, known.whole
        views, predicted = seen.views, seen.drawn
        if not views:
            return None
        if with_depth:
            views = with_depths(fitter, predicted, views, frames, p.depths)
            probe("clothes.depths")
        motion = None
        if last is not None:
            motion = prediction_prior(
                fitter, last, known.motion.velocity, dt_s, p.limbs.uncertain_arm, p.motion
            )

        planted = self._planted()

        def terms_of(drawn: MotionState, shown: Sequence[View]) -> tuple[Term, ...]:
            measured = self.terms.measured(fitter, drawn, shown, frames, ticks.turn)
            return (*measured, *seen.joints, *planted)

        terms = terms_of(predicted, views)
        probe("clothes.distances")
        fit = fitter.fit(
            predicted, views, dt_s, p.fit.iterations - self.work.fewer_iterations, rendered=True,
            fine=min(self.work.fine, p.fit.fine_iterations), motion=motion, terms=terms,
        )  # fmt: skip
        probe("clothes.fit")
        at = Situation(
            self.wardrobe.dressed, dt_s, frames, ticks, seen.joints,
            PoseEvidence(self.cameras.classified, terms_of),
        )  # fmt: skip
        found = self._others.improve(Judged(fit, views, terms), at, self._searches(ticks), probe)
        return self._found(found, known.motion, dt_s, frames.t_ns)

    def below(
        self,
        known: TrackState,
        start: MotionState,
        seen: Observed | None,
        dt_s: float,
        frames: FrameSet,
        ticks: Ticks,
        probe: Probe,
    ) -> ClothesFound | None:
        """Legs and head of a body whose trunk and arms, in `start`, the shirt carries; dt_s after it was known."""
        p, cameras = self.params, self.cameras
        if cameras.are_new:
            cameras.mark_body(start)
            cameras.seed_background()
        # legs that were not seen before have a way to go
        is_new = known.whole is None
        iterations = (
            p.start.iterations if is_new else p.guided_iterations - self.work.fewer_iterations
        )
        dt_s = BEGUN_S if is_new else dt_s
        held = self._held(known, dt_s)
        if not cameras.know_appearance:
            return self._outlined(
                start, None if is_new else known.motion, dt_s, held, iterations, ticks
            )
        if seen is None:
            views, rays = cameras.prepared(start, self.looks_round(ticks), unwatched)
            seen = Observed(start, views, self.terms.joints.term(self.model, rays))
        if not seen.views:
            return None
        fitter = self.fitter

        planted = self._planted()

        def terms_of(drawn: MotionState, shown: Sequence[View]) -> tuple[Term, ...]:
            measured = self.terms.measured(fitter, drawn, shown, frames, ticks.turn, _BELOW)
            return (*measured, *seen.joints, *planted)

        terms = terms_of(seen.drawn, seen.views)
        probe("clothes.distances")
        fit = fitter.fit(
            start, seen.views, dt_s, iterations, rendered=seen.drawn is start, fine=1, motion=held,
            terms=terms,
        )  # fmt: skip
        probe("clothes.fit")
        at = Situation(
            self.wardrobe.dressed, dt_s, frames, ticks, seen.joints,
            PoseEvidence(cameras.classified, terms_of), held,
        )  # fmt: skip
        found = self._others.improve(
            Judged(fit, seen.views, terms), at, self._searches(ticks), probe
        )
        return self._found(found, None if is_new else known.motion, dt_s, frames.t_ns)

    def begin(self, there: MotionState, frames: FrameSet, ticks: Ticks) -> ClothesFound | None:
        """Begin from a body as it was known elsewhere, if the pictures have its outline: what is beside it is the
        background."""
        cameras = self.cameras
        cameras.mark_body(there)
        if cameras.outline_contrast() < self.params.least_contrast:
            return None
        cameras.seed_background()
        cameras.update_foreground()
        self.wardrobe.learn_first(there, cameras)
        fitter, views = self.fitter, cameras.classified(there)
        if not views:
            return None
        fit = fitter.fit(
            there, views, BEGUN_S, self.params.fit.iterations,
            terms=self.terms.measured(fitter, there, views, frames, ticks.turn),
        )  # fmt: skip
        return self._found(Judged(fit, views, ()), None, BEGUN_S)

    def _outlined(
        self,
        start: MotionState,
        last: MotionState | None,
        dt_s: float,
        held: Floats,
        iterations: int,
        ticks: Ticks,
    ) -> ClothesFound | None:
        """Somebody whose look is not known yet, by what stands before the background; it is learned then."""
        p, cameras = self.params, self.cameras
        cameras.mark_body(start)
        cameras.renew_before(self.looks_round(ticks))
        views = cameras.silhouettes(start)
        if not views:
            return None
        fit = self.silhouettes.fit(
            start, views, dt_s, iterations, fine=1, motion=held, terms=(self.terms.floor,)
        )  # fmt: skip
        if fit.explained >= p.learn_explained:
            self.wardrobe.learn_first(fit.state, cameras)
        return self._found(Judged(fit, views, ()), last, dt_s)

    def _planted(self) -> tuple[Term, ...]:
        """What holds the feet that stand."""
        joints = self._feet.joints
        if not len(joints):
            return ()
        return (PlantedTerm(self.model, joints, self._feet.places_m, self.params.planted),)

    def _found(
        self, judged: Judged, last: MotionState | None, dt_s: float, t_ns: int | None = None
    ) -> ClothesFound | None:
        fit, changed = judged.fit, judged.changed
        if not _is_believed(fit, self.params):
            return None
        velocity = np.zeros(self.model.n_pose)
        if last is not None:
            velocity = _velocity_of(self.model, self.params, fit, last, dt_s, changed)
        if t_ns is not None:
            self._feet.saw(self.fitter.joints(fit.state)[0], t_ns)
        views = tuple(judged.views)
        motion = replace(fit.state, velocity=velocity)
        return ClothesFound(fit, motion, views, self.cameras.names(views), changed)

    def _held(self, known: TrackState, dt_s: float) -> Floats:
        """Information (n_pose,n_pose) of a prediction whose trunk and arms the shirt carries."""
        held = np.zeros(self.model.n_pose)
        held[:3] = self.params.guided_sd_m**-2
        held[3 : upper_body().n_pose] = self.params.guided_sd_rad**-2
        if known.whole is None:
            return np.diag(held + 1.0 / (self.fitter.prediction_sd**2 * max(dt_s / TICK_S, 0.5)))
        p = self.params
        motion = prediction_prior(
            self.fitter, known.whole, known.motion.velocity, dt_s, p.limbs.uncertain_arm, p.motion
        )
        return np.asarray(motion + np.diag(held))


def _is_believed(fit: Fit, params: ClothesParams) -> bool:
    """Whether enough of the body agrees with the pictures."""
    # every second pixel was counted
    enough = 2.0 * fit.matched.sum() >= params.least_body_px
    return fit.explained >= params.live_explained and bool(enough)


def _velocity_of(
    model: BodyModel,
    params: ClothesParams,
    fit: Fit,
    last: MotionState,
    dt_s: float,
    changed: Sequence[str],
) -> Floats:
    """Of the pose (n_pose,) per second, from the step since the last one; not of parts that changed over."""
    columns = [slice(None) if part == WHOLE else model.space.columns(part) for part in changed]
    return velocity_between(model, last, fit, dt_s, columns, params.velocity)
