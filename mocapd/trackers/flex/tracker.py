"""The tracker without a shirt: a whole body before a known background, its look learned, fitted in all views at once."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from mocapd.body.model import build_model
from mocapd.body.pose_space import SIDES, full_body
from mocapd.body.regions import as_silhouette
from mocapd.body.shape import BodyShape
from mocapd.body.skeleton import N_JOINTS, standard_skeleton
from mocapd.clock import nanoseconds, seconds
from mocapd.each import Each, in_turn
from mocapd.fit.body_drawing import image_scales
from mocapd.fit.fit_params import TICK_S
from mocapd.fit.motion_prior import predicted_information
from mocapd.fit.motion_state import MotionState, gone_on, initial_information, known_of
from mocapd.fit.solver import Fitter, View
from mocapd.fit.terms.pose_term import PoseTerm
from mocapd.geometry import rotations
from mocapd.trackers import steadying
from mocapd.trackers.base import Probe, Track, lost_body, no_time_passes, require_stature, unprobed
from mocapd.trackers.depth_views import with_depths
from mocapd.trackers.flex.camera_views import CameraViews
from mocapd.trackers.flex.joint_views import unwatched
from mocapd.trackers.flex.led import TAKEN_OVER_S, LegsBelow, taken_over
from mocapd.trackers.flex.looks.look import DressedFitters
from mocapd.trackers.flex.memory import (
    Followed,
    Proportions,
    is_believed,
    of_wearer,
    velocity_of,
)
from mocapd.trackers.flex.params import Params
from mocapd.trackers.flex.person_search import PersonSearch
from mocapd.trackers.flex.pose_terms import PoseTerms
from mocapd.trackers.flex.rescue.other_poses import OtherPoses
from mocapd.trackers.flex.rescue.seen_tries import Anew
from mocapd.trackers.flex.telling import told_of
from mocapd.trackers.flex.wardrobe import Wardrobe, learn_on
from mocapd.trackers.steadying import Told
from mocapd.trackers.told_pose import told_pose
from mocapd.trackers.tracking_state import TrackingState, TrackingStateParams, faded
from mocapd.types import BodyState, Frame, FrameSet, Rig, Tracking
from mocapd.vision.face.lbp_cascade import blind_cascade
from mocapd.vision.face.lbp_cascade_kernels import CascadeArrays

_TOO_OLD_S = 1.0  # a pose is not predicted from any longer; a busy machine may skip many frames


class FlexTracker:
    """Two cameras or more see a whole person in any clothes; see `mocapd.trackers.base.Tracker` for the promises."""

    name = "flex"

    def __init__(
        self,
        rig: Rig,
        stature_m: float,
        params: Params | None = None,
        tracking: TrackingStateParams | None = None,
        cascade: CascadeArrays | None = None,
        each: Each = in_turn,
        now_ns: Callable[[], int] = no_time_passes,
    ) -> None:
        """cascade: of frontal faces, see `vision.face.lbp_cascade`; None: faces tell nothing. each: of the cameras.
        now_ns: see `registry.Resources`."""
        self.params = p = params if params is not None else Params()
        self.rig = rig
        body = build_model(stature_m, full_body())
        smaller = image_scales(rig.cameras, p.fit.work_width_px)
        fitters = DressedFitters(body, rig.cameras, smaller, p.fit, p.limbs, p.legs, each)
        self._wardrobe = Wardrobe(fitters, p)
        self._silhouettes = Fitter(as_silhouette(body), rig.cameras, smaller, p.fit, each)
        self._model = self._wardrobe.fitter.model
        self._skeleton = standard_skeleton(stature_m)
        self._terms = PoseTerms(self._model, len(rig.cameras), p)
        self._cameras = CameraViews(self._wardrobe.fitter, p)
        self._find = PersonSearch(
            self._silhouettes, self._terms.floor, self._terms.joints, self._cameras, rig.cameras, p.start,
            p.keypoint_start, p.motion_watch, now_ns,
        )  # fmt: skip
        self._others = OtherPoses(p, stature_m, cascade or blind_cascade())
        self._legs_below = LegsBelow(
            p, self._skeleton, self._cameras, self._wardrobe, self._silhouettes, self._terms, self._others
        )  # fmt: skip
        self._tracking = TrackingState(tracking)
        self.probe: Probe = unprobed
        self._rehearse()
        self.reset()

    def _rehearse(self) -> None:
        """Compile or load the kernels that no frame of an empty room reaches: whoever comes must not wait for them."""
        model, cameras = self._model, self._cameras
        local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
        somebody = MotionState(
            model.rest_m[0].copy(), local, np.zeros(model.n_pose), np.ones(model.n_shape), initial_information(model.space)
        )  # fmt: skip
        black = {
            one.name: Frame(one.name, 0, 0, np.zeros((*one.size_px[::-1], 3), np.uint8))
            for one in self.rig.cameras
        }
        steadying.rehearse()
        self.reset()
        cameras.look(FrameSet(0, black, 0))
        cameras.mark_body(somebody)
        cameras.seed_background()
        cameras.stand_before()
        self._wardrobe.learn_first(somebody, cameras)
        views = cameras.classified(somebody)
        if not views:
            return  # nobody at the origin is in any picture
        fitter, frames = self._wardrobe.fitter, FrameSet(0, black, 0)
        views = with_depths(fitter, somebody, views, frames, self.params.depths)
        if fitter.is_narrow(somebody, views):  # black pictures have no depths
            unseen = np.full(views[0].ids.shape, np.nan, np.float32)
            views[0] = replace(views[0], depth_m=unseen)
        joints = self._terms.joints
        watched = map(joints.watch(fitter, somebody, cameras), cameras.present)
        seen = joints.term(self._model, watched)
        terms = (*self._terms.measured(fitter, somebody, views, frames, self._turn), *seen)
        fit = fitter.fit(somebody, views, TICK_S, 2, learn_shape=False, terms=terms)
        still, usual_sd = somebody.velocity, fitter.prediction_sd
        predicted_information(fit.covariance, still, 1.0, usual_sd, [], self.params.motion)
        cameras.learn(somebody, views)
        velocity_of(self._model, self.params, fit, somebody, TICK_S, ())
        told_pose(fitter, somebody, fit, None, 0.0, self.params.prediction_damping)
        self._others.rehearse(self._wardrobe.dressed, somebody, views, seen)

    def reset(self, near: BodyState | None = None) -> None:
        """Forget pose, background and appearance. near: a body to be looked for where it is, before everywhere."""
        self._cameras.reset()
        self._wardrobe.forget(self._cameras)
        self._tracking.reset(None if near is None or near.pose is None else near.t_ns)
        self._known: Followed | None = None
        self._told: Told | None = None
        self._near = near
        self._find.reset()
        self._others.reset()
        self._legs_below.reset()
        self._turn = 0
        self._looked_at: FrameSet | None = None  # of which there was no step yet

    def learn_room(self, frames: Iterable[FrameSet]) -> None:
        """Learn the background from a recording, before its first step. Raises ConfigError as `step` does."""
        self._cameras.learn_room(frames)

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        """Track one frame set. Raises ConfigError when a frame's size is not its calibration's."""
        wearer, known = self._begin(frames, shape)
        views: list[View] = []
        if self._cameras.present:
            if known is not None:
                known, views = self._follow(of_wearer(known, wearer), frames)
            elif self._near is not None:
                known, views = self._take_over(self._near, wearer, frames)
                self._near = None
            else:
                known, views = self._start(wearer, frames)
        # depths and arms that are searched for make their frames long enough
        taught = [] if self._measures_depths else views
        return self._end(known, views, frames, shape, taught)

    def prepare(self, frames: FrameSet) -> None:
        """Take the pictures, and classify them by the body as it goes on from the last ones. Raises as `step`."""
        self._look(frames)
        known = self._recent(frames)
        if known is not None and self._cameras.present:
            self._legs_below.prepare(known, frames, self._turn)

    def step_guided(self, frames: FrameSet, shape: BodyShape, upper: BodyState) -> Track:
        """Track one frame set whose upper body another tracker knows: legs and head alone are fitted. Raises as `step`,
        and ValueError for an upper body without a pose."""
        if upper.pose is None:
            raise ValueError("a guide that knows no pose")
        wearer, known = self._begin(frames, shape)
        self._near = None
        self._find.give_up()
        views: list[View] = []
        if self._cameras.present:
            known, views = self._legs_below.follow(
                known, upper.pose, wearer, frames, self._turn, self.probe
            )
        # with two cameras: the look is learned in one of them, in two of four frames
        return self._end(known, views, frames, shape, views[self._turn % 4 :: 4])

    def _begin(self, frames: FrameSet, shape: BodyShape) -> tuple[Proportions, Followed | None]:
        """The wearer of this step, and what is known of the last one."""
        require_stature(shape, self._model.stature_m)
        if self._looked_at is not frames:
            self._look(frames)
        self._looked_at = None
        self.probe("picture")
        return Proportions(*known_of(shape, self._model.space)), self._recent(frames)

    def _look(self, frames: FrameSet) -> None:
        self._turn += 1
        self._find.times.came(frames.t_ns)
        self._cameras.look(frames)
        self._looked_at = frames

    def _recent(self, frames: FrameSet) -> Followed | None:
        """What is known, unless it is too old to predict from."""
        known = self._known
        if known is None or frames.t_ns - known.t_ns > nanoseconds(_TOO_OLD_S):
            return None
        return known

    def _end(
        self,
        known: Followed | None,
        views: list[View],
        frames: FrameSet,
        shape: BodyShape,
        taught: list[View],
    ) -> Track:
        """Judge, learn (the look in the views `taught`), and tell."""
        evidence = known is not None and known.t_ns == frames.t_ns
        tracking = self._tracking.step(frames.t_ns, evidence)
        if tracking is Tracking.LOST and not evidence:
            known = None
        self._known = known
        learn_on(
            self._cameras, known if evidence else None, taught, known is None, self._turn, self.params
        )  # fmt: skip
        self.probe("learn")
        return self._track(tracking, frames, views, shape)

    @property
    def _measures_depths(self) -> bool:
        """Whether this frame does, where cameras look from one side; the others look for joints, and learn."""
        return self._turn % self.params.depth_turns == 0

    # --- stages ---

    def _follow(self, known: Followed, frames: FrameSet) -> tuple[Followed, list[View]]:
        """One frame of tracking; a frame without evidence leaves `known` at its old time."""
        p, fitter, last = self.params, self._wardrobe.fitter, known.state
        dt_s = max(seconds(frames.t_ns - known.t_ns), 1e-3)
        predicted = gone_on(self._model, last, dt_s, p.prediction_damping)
        # each of the two takes long: joints in frames without depths
        with_joints = not self._measures_depths
        joints = self._terms.joints
        watch = joints.watch(fitter, predicted, self._cameras) if with_joints else unwatched
        views, rays = self._cameras.prepared(predicted, self._turn, watch)
        self.probe("cameras")
        if not views:
            return known, views
        seen = joints.term(self._model, rays)
        if not with_joints:
            views = with_depths(fitter, predicted, views, frames, p.depths)
            self.probe("depths")
        confirmed, columns = known.fit.confirmed_arms, self._model.space.columns
        motion = predicted_information(
            known.fit.covariance, last.velocity * dt_s, dt_s / TICK_S, fitter.prediction_sd,
            [(columns(f"{s}_arm"), min(confirmed[s] / p.limbs.uncertain_arm, 1.0)) for s in SIDES], p.motion,
        )  # fmt: skip

        def terms_of(drawn: MotionState, shown: Sequence[View]) -> tuple[PoseTerm, ...]:
            return (*self._terms.measured(fitter, drawn, shown, frames, self._turn), *seen)

        terms = terms_of(predicted, views)
        self.probe("distances")
        fit = fitter.fit(
            predicted, views, dt_s, p.fit.iterations, learn_shape=False, rendered=True, motion=motion, terms=terms,
        )  # fmt: skip
        self.probe("fit")
        fit, views, changed = self._others.improve(
            self._wardrobe.dressed, fit, views, dt_s, frames, self._turn, terms, seen,
            Anew(self._cameras.classified, terms_of), self.probe,
        )  # fmt: skip
        if not is_believed(fit, p):
            return known, views
        velocity = velocity_of(self._model, p, fit, last, dt_s, changed)
        state = replace(fit.state, velocity=velocity)
        return Followed(frames.t_ns, state, fit, self._cameras.names(views), changed), views

    def _start(self, wearer: Proportions, frames: FrameSet) -> tuple[Followed | None, list[View]]:
        """Look for somebody who stands before the background."""
        found = self._find.look(wearer.factors, wearer.information, frames.t_ns)
        self.probe("start")
        if found is None:
            return None, []
        fit, names = found
        self._cameras.mark_body(fit.state)
        self._cameras.take_uncovered()
        self._cameras.doubt_background()
        self._wardrobe.learn_first(fit.state, self._cameras)
        return Followed(frames.t_ns, fit.state, fit, names), []

    def _take_over(
        self, near: BodyState, wearer: Proportions, frames: FrameSet
    ) -> tuple[Followed | None, list[View]]:
        """Begin from another tracker's body, if the pictures have its outline: what is beside it is the background."""
        pose = near.pose
        if pose is None or abs(frames.t_ns - near.t_ns) > nanoseconds(_TOO_OLD_S):
            return None, []
        there = taken_over(self._model, self._skeleton, pose, wearer)
        self._cameras.mark_body(there)
        if self._cameras.outline_contrast() < self.params.least_contrast:
            return None, []
        self._cameras.seed_background()
        self._cameras.stand_before()
        self._wardrobe.learn_first(there, self._cameras)
        views = self._cameras.classified(there)
        if not views:
            return None, []
        fitter = self._wardrobe.fitter
        fit = fitter.fit(
            there, views, TAKEN_OVER_S, self.params.fit.iterations, learn_shape=False,
            terms=self._terms.measured(fitter, there, views, frames, self._turn),
        )  # fmt: skip
        if not is_believed(fit, self.params):
            return None, []
        return Followed(frames.t_ns, fit.state, fit, self._cameras.names(views)), views

    # --- result ---

    def _track(
        self, tracking: Tracking, frames: FrameSet, views: list[View], shape: BodyShape
    ) -> Track:
        known = self._known
        if tracking is Tracking.LOST or known is None:
            self._told = None
            reason = self._find.lost_reason(frames.t_ns)
            return Track(lost_body(frames.t_ns, self.name), shape, lost_reason=reason)
        body, self._told = told_of(
            known, self._told, frames.t_ns, tracking, self.name, self._wardrobe.fitter, shape, self.params
        )  # fmt: skip
        evidence, roi_px = self._cameras.evidence(views)
        agrees = known.fit.explained * faded(seconds(frames.t_ns - known.t_ns))
        return Track(body, shape, agrees, evidence, roi_px)
