"""The tracker without a shirt: a whole body before a known background, its look learned, fitted in all views at once."""

from collections.abc import Callable, Collection, Iterable, Sequence
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
from mocapd.fit.motion_state import MotionState, initial_information, known_of, moved
from mocapd.fit.solver import Fit, Fitter, View
from mocapd.fit.terms.floor_term import FloorTerm
from mocapd.fit.terms.joint_term import JointTerm
from mocapd.fit.terms.pose_term import PoseTerm
from mocapd.geometry import rotations
from mocapd.trackers.base import Probe, Track, lost_body, no_time_passes, require_stature, unprobed
from mocapd.trackers.depth_views import with_depths
from mocapd.trackers.flex.camera_views import CameraViews
from mocapd.trackers.flex.joint_views import JointViews
from mocapd.trackers.flex.led import (
    LEGS,
    TAKEN_OVER_S,
    guided_information,
    predicted_below,
    standing_below,
    taken_over,
)
from mocapd.trackers.flex.looks.look import ALL_DIFFER, DressedFitters, Look, look_of
from mocapd.trackers.flex.memory import Followed, Proportions, of_wearer, velocity_of
from mocapd.trackers.flex.params import Params
from mocapd.trackers.flex.person_search import PersonSearch
from mocapd.trackers.flex.rescue.other_poses import OtherPoses
from mocapd.trackers.flex.telling import told_of
from mocapd.trackers.steadying import Told
from mocapd.trackers.texture_distance import texture_distances
from mocapd.trackers.tracking_state import TrackingState, TrackingStateParams, faded
from mocapd.types import BodyState, Frame, FrameSet, Pose, Rig, Tracking
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
        self._fitters = DressedFitters(body, rig.cameras, smaller, p.fit, p.limbs, p.legs, each)
        self._dressed = self._fitters.of(ALL_DIFFER)
        self._fitter = self._dressed.fitter
        self._silhouettes = Fitter(as_silhouette(body), rig.cameras, smaller, p.fit, each)
        self._model = self._fitter.model
        self._skeleton = standard_skeleton(stature_m)
        self._floor = FloorTerm(self._model, p.floor)
        self._cameras = CameraViews(self._fitter, p)
        self._find = PersonSearch(
            self._silhouettes, self._floor, self._cameras, rig.cameras, p.start, now_ns
        )
        self._others = OtherPoses(p, stature_m, cascade or blind_cascade())
        self._joints = JointViews(len(rig.cameras), stature_m, p.joints)
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
        self.reset()
        cameras.look(FrameSet(0, black, 0))
        cameras.mark_body(somebody)
        cameras.seed_background()
        cameras.stand_before()
        self._learn_first(somebody)
        views = cameras.classified(somebody)
        if not views:
            return  # nobody at the origin is in any picture
        views = with_depths(
            self._fitter, somebody, views, FrameSet(0, black, 0), self.params.depths
        )
        seen = self._joints.look(self._fitter, somebody, cameras)
        terms = (*self._terms(somebody, views, FrameSet(0, black, 0)), *seen)
        fit = self._fitter.fit(somebody, views, TICK_S, 2, learn_shape=False, terms=terms)
        still, usual_sd = somebody.velocity, self._fitter.prediction_sd
        predicted_information(fit.covariance, still, 1.0, usual_sd, [], self.params.motion)
        cameras.learn_appearance(somebody, views)
        self._others.rehearse(self._dressed, somebody, views, seen)

    def reset(self, near: BodyState | None = None) -> None:
        """Forget pose, background and appearance. near: a body to be looked for where it is, before everywhere."""
        self._cameras.reset()
        self._dress(ALL_DIFFER)
        self._tracking.reset(None if near is None or near.pose is None else near.t_ns)
        self._known: Followed | None = None
        self._told: Told | None = None
        self._near = near
        self._find.reset()
        self._others.reset()
        self._turn = 0
        self._led_steps = 0

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
        return self._end(known, views, frames, shape)

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
            known, views = self._follow_guide(known, upper.pose, wearer, frames)
        return self._end(known, views, frames, shape, every=2)

    def _begin(self, frames: FrameSet, shape: BodyShape) -> tuple[Proportions, Followed | None]:
        """The wearer of this step, and what is known of the last one."""
        self._turn += 1
        self._find.times.came(frames.t_ns)
        require_stature(shape, self._model.stature_m)
        self._cameras.look(frames)
        self.probe("picture")
        known = self._known
        if known is not None and frames.t_ns - known.t_ns > nanoseconds(_TOO_OLD_S):
            known = None  # too old to predict from
        return Proportions(*known_of(shape, self._model.space)), known

    def _end(
        self,
        known: Followed | None,
        views: list[View],
        frames: FrameSet,
        shape: BodyShape,
        every: int = 1,
    ) -> Track:
        """Judge, learn (in one of `every` cameras), and tell."""
        evidence = known is not None and known.t_ns == frames.t_ns
        tracking = self._tracking.step(frames.t_ns, evidence)
        if tracking is Tracking.LOST and not evidence:
            known = None
        self._known = known
        self._learn(known if evidence else None, views, nobody=known is None, every=every)
        self.probe("learn")
        return self._track(tracking, frames, views, shape)

    # --- stages ---

    def _follow(self, known: Followed, frames: FrameSet) -> tuple[Followed, list[View]]:
        """One frame of tracking; a frame without evidence leaves `known` at its old time."""
        p, fitter, last = self.params, self._fitter, known.state
        dt_s = max(seconds(frames.t_ns - known.t_ns), 1e-3)
        root, local = moved(self._model, last, dt_s, p.prediction_damping)
        predicted = replace(last, root_m=root, local_xyzw=local)
        self._cameras.mark_body(predicted)
        self._stand_before()
        views = self._cameras.classified(predicted, marked=True)
        self.probe("classify")
        if not views:
            return known, views
        seen: tuple[JointTerm, ...] = ()
        if (
            self._turn % p.depth_turns
        ):  # each of the two takes long: joints in frames without depths
            seen = self._joints.look(fitter, predicted, self._cameras)
            self.probe("joints")
        else:
            views = with_depths(fitter, predicted, views, frames, p.depths)
        self.probe("depths")
        confirmed, columns = known.fit.confirmed_arms, self._model.space.columns
        motion = predicted_information(
            known.fit.covariance, last.velocity * dt_s, dt_s / TICK_S, fitter.prediction_sd,
            [(columns(f"{s}_arm"), min(confirmed[s] / p.limbs.uncertain_arm, 1.0)) for s in SIDES], p.motion,
        )  # fmt: skip
        terms = (*self._terms(predicted, views, frames), *seen)
        self.probe("distances")
        fit = fitter.fit(
            predicted, views, dt_s, p.fit.iterations, learn_shape=False, rendered=True, motion=motion, terms=terms,
        )  # fmt: skip
        self.probe("fit")
        fit, changed = self._others.improve(
            self._dressed, fit, views, dt_s, frames, self._turn, terms, seen,
            lambda state: (*self._terms(state, views, frames), *seen), self.probe,
        )  # fmt: skip
        if not self._believed(fit):
            return known, views
        velocity = velocity_of(self._model, p, fit, last, dt_s, changed)
        state = replace(fit.state, velocity=velocity)
        return Followed(frames.t_ns, state, fit, self._names(views), changed), views

    def _follow_guide(
        self, known: Followed | None, upper: Pose, wearer: Proportions, frames: FrameSet
    ) -> tuple[Followed | None, list[View]]:
        """One frame of legs and head below and above a body that another tracker knows."""
        p, cameras, model = self.params, self._cameras, self._model
        last = known.state if known is not None else standing_below(model, upper, wearer)
        dt_s = max(seconds(frames.t_ns - known.t_ns), 1e-3) if known is not None else TAKEN_OVER_S
        predicted = predicted_below(model, self._skeleton, p, last, dt_s, upper, wearer)
        cameras.mark_body(predicted)
        if cameras.are_new:
            cameras.seed_background()
        self._stand_before()
        is_first = not cameras.know_appearance
        self._led_steps = self._led_steps + 1 if known is not None else 0
        fitter = self._silhouettes if is_first else self._fitter
        if is_first:
            views = cameras.silhouettes(predicted)
        else:
            views = cameras.classified(predicted, marked=True)
        self.probe("classify")
        if not views:
            return known, views
        terms: tuple[PoseTerm, ...] = (self._floor,)
        seen: tuple[JointTerm, ...] = ()
        if not is_first:
            # legs that were just found are told as found: what moves them far must wait
            if self._turn % p.guided_joint_turns == 1 and self._led_steps > p.guided_joint_after:
                seen = self._joints.look(fitter, predicted, cameras)
            terms = (*self._terms(predicted, views, frames, LEGS), *seen)
        self.probe("distances")
        held = guided_information(p, fitter.prediction_sd, dt_s)
        # legs that were not seen before have a way to go
        iterations = p.guided_iterations if known is not None else p.start.iterations
        fit = fitter.fit(
            predicted, views, dt_s, iterations, learn_shape=False, rendered=not is_first, fine=1, motion=held,
            terms=terms,
        )  # fmt: skip
        self.probe("fit")
        changed: tuple[str, ...] = ()
        if not is_first:
            fit, changed = self._others.other_legs(
                self._dressed, fit, views, dt_s, self._turn, terms, seen, held
            )
            self.probe("legs")
        if is_first and fit.explained >= p.learn_explained:
            self._learn_first(fit.state)
        if not self._believed(fit):
            return known, views
        velocity = np.zeros(model.n_pose)
        if known is not None:
            velocity = velocity_of(model, p, fit, last, dt_s, changed)
        state = replace(fit.state, velocity=velocity)
        return Followed(frames.t_ns, state, fit, self._names(views), changed), views

    def _stand_before(self) -> None:
        """Renew what stands before the backgrounds, now and then everywhere, where something may have been uncovered."""
        looks_round = self._turn % self.params.uncovered_turns == 0
        self._cameras.stand_before(everywhere=looks_round)
        if looks_round:
            self._cameras.take_uncovered()
        self.probe("background")

    def _terms(
        self,
        predicted: MotionState,
        views: Sequence[View],
        frames: FrameSet,
        only: Collection[int] = (),
    ) -> tuple[PoseTerm, ...]:
        """What holds the pose beside the regions: the floor, and distances where two cameras look from one side, of all
        regions or of these only."""
        measured = texture_distances(
            self._fitter, predicted, views, frames, self._turn, self.params.distances, only
        )
        return (self._floor, *measured)

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
        self._learn_first(fit.state)
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
        self._learn_first(there)
        views = self._cameras.classified(there)
        if not views:
            return None, []
        fit = self._fitter.fit(
            there, views, TAKEN_OVER_S, self.params.fit.iterations, learn_shape=False,
            terms=self._terms(there, views, frames),
        )  # fmt: skip
        if not self._believed(fit):
            return None, []
        return Followed(frames.t_ns, fit.state, fit, self._names(views)), views

    def _believed(self, fit: Fit) -> bool:
        """Whether enough of the body agrees with the pictures."""
        p = self.params
        # every second pixel was counted
        return fit.explained >= p.live_explained and 2.0 * fit.matched.sum() >= p.least_body_px

    def _learn(
        self, seen: Followed | None, views: Sequence[View], nobody: bool, every: int
    ) -> None:
        """Learn the look of a body that agrees well, in one of `every` cameras, and the background beside it, or everywhere
        when nobody is known."""
        if seen is not None and seen.fit.explained >= self.params.learn_explained:
            self._cameras.learn_appearance(seen.state, views[self._turn % every :: every])
        if nobody and self._turn % self.params.absorb_turns:
            # what stays for long is furniture that was moved
            self._cameras.mark_unknown()
        elif nobody:
            self._cameras.mark_body(None)
        self._cameras.learn_background()

    def _learn_first(self, state: MotionState) -> None:
        """Learn the look of somebody who was found."""
        self._dress(ALL_DIFFER)
        self._cameras.learn_first_appearance(state)
        seen = [self._cameras.each[i].appearance for i in self._cameras.present]
        look = look_of(seen, self.params.alike)
        for camera in self._cameras.each:
            camera.appearance.join(look)
        self._dress(look)

    def _dress(self, look: Look) -> None:
        self._dressed = self._fitters.of(look)
        self._fitter = self._dressed.fitter
        self._cameras.fitter = self._fitter

    def _names(self, views: Sequence[View]) -> tuple[str, ...]:
        return tuple(self._cameras.each[v.index].name for v in views)

    # --- result ---

    def _track(
        self, tracking: Tracking, frames: FrameSet, views: list[View], shape: BodyShape
    ) -> Track:
        known = self._known
        if tracking is Tracking.LOST or known is None:
            self._told = None
            return Track(lost_body(frames.t_ns, self.name), shape)
        body, self._told = told_of(
            known, self._told, frames.t_ns, tracking, self.name, self._fitter, shape, self.params
        )
        evidence, roi_px = self._cameras.evidence(views)
        agrees = known.fit.explained * faded(seconds(frames.t_ns - known.t_ns))
        return Track(body, shape, agrees, evidence, roi_px)
