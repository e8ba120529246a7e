"""The tracker without a shirt: a whole body before a known background, its look learned, fitted in all views at once."""

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mocapd.body.model import build_model
from mocapd.body.pose_space import SIDES, full_body, upper_body
from mocapd.body.regions import Region, as_silhouette
from mocapd.body.shape import BodyShape, skeleton_of
from mocapd.body.skeleton import (
    INDEX,
    N_JOINTS,
    joint_positions,
    local_from_global,
    standard_skeleton,
)
from mocapd.clock import nanoseconds, seconds
from mocapd.each import Each, in_turn
from mocapd.fit.body_drawing import image_scales
from mocapd.fit.fit_params import TICK_S
from mocapd.fit.motion_prior import predicted_information
from mocapd.fit.motion_state import MotionState, initial_information, known_of, moved, step_between
from mocapd.fit.solver import Fit, Fitter, View
from mocapd.fit.terms.floor_term import FloorTerm
from mocapd.fit.terms.pose_term import PoseTerm
from mocapd.geometry import rotations
from mocapd.trackers.base import Probe, Track, lost_body, no_time_passes, require_stature, unprobed
from mocapd.trackers.depth_views import with_depths
from mocapd.trackers.flex.camera_views import CameraViews
from mocapd.trackers.flex.confidence import joint_confidence
from mocapd.trackers.flex.look import ALL_DIFFER, DressedFitters, Look, look_of
from mocapd.trackers.flex.other_poses import WHOLE, OtherPoses
from mocapd.trackers.flex.params import Params
from mocapd.trackers.flex.person_search import PersonSearch
from mocapd.trackers.steadying import Told, behind, steadied
from mocapd.trackers.texture_distance import texture_distances
from mocapd.trackers.told_pose import told_pose
from mocapd.trackers.tracking_state import TrackingState, TrackingStateParams, faded, grown
from mocapd.types import BodyState, Floats, Frame, FrameSet, Pose, Rig, Tracking
from mocapd.vision.face.lbp_cascade import blind_cascade
from mocapd.vision.face.lbp_cascade_kernels import CascadeArrays

_TAKEN_OVER_S = 0.1  # another tracker's body is held as loosely as a prediction over this time
_UPPER = np.flatnonzero(upper_body().group_of_joint >= 0)  # joints that a guide knows
_LEGS = (Region.LEG, Region.FOOT)
_TOO_OLD_S = 1.0  # a pose is not predicted from any longer; a busy machine may skip many frames


@dataclass(frozen=True, slots=True, eq=False)
class _Memory:
    """What is carried from frame to frame while somebody is tracked."""

    t_ns: int
    state: MotionState
    fit: Fit
    cameras: tuple[str, ...]
    changed: tuple[str, ...] = ()  # parts of the body that were found elsewhere


@dataclass(frozen=True, slots=True, eq=False)
class _Wearer:
    """The proportions as handed in, in the tracker's space."""

    factors: Floats
    information: Floats


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
        self._arm_columns = {side: self._model.space.columns(f"{side}_arm") for side in SIDES}
        self._cameras = CameraViews(self._fitter, p)
        self._find = PersonSearch(
            self._silhouettes, self._floor, self._cameras, rig.cameras, p.start, now_ns
        )
        self._others = OtherPoses(p, stature_m, cascade or blind_cascade())
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
        terms = self._terms(somebody, views, FrameSet(0, black, 0))
        fit = self._fitter.fit(somebody, views, TICK_S, 2, learn_shape=False, terms=terms)
        still, usual_sd = somebody.velocity, self._fitter.prediction_sd
        predicted_information(fit.covariance, still, 1.0, usual_sd, [], self.params.motion)
        cameras.learn_appearance(somebody, views)
        self._others.rehearse(self._dressed, somebody, views)

    def reset(self, near: BodyState | None = None) -> None:
        """Forget pose, background and appearance. near: a body to be looked for where it is, before everywhere."""
        self._cameras.reset()
        self._dress(ALL_DIFFER)
        self._tracking.reset(None if near is None or near.pose is None else near.t_ns)
        self._known: _Memory | None = None
        self._told: Told | None = None
        self._near = near
        self._find.reset()
        self._others.reset()
        self._turn = 0

    def learn_room(self, frames: Iterable[FrameSet]) -> None:
        """Learn the background from a recording, before its first step. Raises ConfigError as `step` does."""
        self._cameras.learn_room(frames)

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        """Track one frame set. Raises ConfigError when a frame's size is not its calibration's."""
        wearer, known = self._begin(frames, shape)
        views: list[View] = []
        if self._cameras.present:
            if known is not None:
                known, views = self._follow(_with(known, wearer), frames)
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

    def _begin(self, frames: FrameSet, shape: BodyShape) -> tuple[_Wearer, _Memory | None]:
        """The wearer of this step, and what is known of the last one."""
        self._turn += 1
        self._find.times.came(frames.t_ns)
        require_stature(shape, self._model.stature_m)
        self._cameras.look(frames)
        self.probe("picture")
        known = self._known
        if known is not None and frames.t_ns - known.t_ns > nanoseconds(_TOO_OLD_S):
            known = None  # too old to predict from
        return _Wearer(*known_of(shape, self._model.space)), known

    def _end(
        self,
        known: _Memory | None,
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

    def _follow(self, known: _Memory, frames: FrameSet) -> tuple[_Memory, list[View]]:
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
        if self._turn % p.depth_turns == 0:
            views = with_depths(fitter, predicted, views, frames, p.depths)
        self.probe("depths")
        confirmed = known.fit.confirmed_arms
        motion = predicted_information(
            known.fit.covariance, last.velocity * dt_s, dt_s / TICK_S, fitter.prediction_sd,
            [(self._arm_columns[s], min(confirmed[s] / p.limbs.uncertain_arm, 1.0)) for s in SIDES], p.motion,
        )  # fmt: skip
        terms = self._terms(predicted, views, frames)
        self.probe("distances")
        fit = fitter.fit(
            predicted, views, dt_s, p.fit.iterations, learn_shape=False, rendered=True, motion=motion, terms=terms,
        )  # fmt: skip
        self.probe("fit")
        fit, changed = self._others.improve(
            self._dressed, fit, views, dt_s, frames, self._turn, terms,
            lambda state: self._terms(state, views, frames), self.probe,
        )  # fmt: skip
        if not self._believed(fit):
            return known, views
        state = fit.state
        velocity = self._velocity(fit, last, dt_s, changed)
        return _Memory(
            frames.t_ns, replace(state, velocity=velocity), fit, self._names(views), tuple(changed)
        ), views

    def _follow_guide(
        self, known: _Memory | None, upper: Pose, wearer: _Wearer, frames: FrameSet
    ) -> tuple[_Memory | None, list[View]]:
        """One frame of legs and head below and above a body that another tracker knows."""
        p, cameras, model = self.params, self._cameras, self._model
        last = known.state if known is not None else self._standing_below(upper, wearer)
        dt_s = max(seconds(frames.t_ns - known.t_ns), 1e-3) if known is not None else _TAKEN_OVER_S
        local = moved(model, last, dt_s, p.prediction_damping)[1]
        local[_UPPER] = local_from_global(self._skeleton, upper.quats_xyzw)[_UPPER]
        predicted = MotionState(
            upper.root_m.copy(), local, last.velocity, wearer.factors, wearer.information
        )
        cameras.mark_body(predicted)
        if cameras.are_new:
            cameras.seed_background()
        self._stand_before()
        is_first = not cameras.know_appearance
        fitter = self._silhouettes if is_first else self._fitter
        if is_first:
            views = cameras.silhouettes(predicted)
        else:
            views = cameras.classified(predicted, marked=True)
        self.probe("classify")
        if not views:
            return known, views
        held = np.zeros(model.n_pose)
        held[:3] = p.guided_sd_m**-2
        held[3 : upper_body().n_pose] = p.guided_sd_rad**-2
        terms: tuple[PoseTerm, ...] = (self._floor,)
        if not is_first:
            terms = self._terms(predicted, views, frames, _LEGS)
        self.probe("distances")
        loose = np.diag(held + 1.0 / (fitter.prediction_sd**2 * max(dt_s / TICK_S, 0.5)))
        # legs that were not seen before have a way to go
        iterations = p.guided_iterations if known is not None else p.start.iterations
        fit = fitter.fit(
            predicted, views, dt_s, iterations, learn_shape=False, rendered=not is_first, fine=1, motion=loose,
            terms=terms,
        )  # fmt: skip
        self.probe("fit")
        changed: tuple[str, ...] = ()
        if not is_first:
            fit, changed = self._others.other_legs(
                self._dressed, fit, views, dt_s, self._turn, terms, loose
            )
            self.probe("legs")
        if is_first and fit.explained >= p.learn_explained:
            self._learn_first(fit.state)
        if not self._believed(fit):
            return known, views
        velocity = np.zeros(model.n_pose)
        if known is not None:
            velocity = self._velocity(fit, last, dt_s, changed)
        return _Memory(
            frames.t_ns,
            replace(fit.state, velocity=velocity),
            fit,
            self._names(views),
            tuple(changed),
        ), views

    def _stand_before(self) -> None:
        """Renew what stands before the backgrounds, now and then everywhere, where something may have been uncovered."""
        looks_round = self._turn % self.params.uncovered_turns == 0
        self._cameras.stand_before(everywhere=looks_round)
        if looks_round:
            self._cameras.take_uncovered()
        self.probe("background")

    def _standing_below(self, upper: Pose, wearer: _Wearer) -> MotionState:
        """Somebody with this upper body whose legs hang straight down."""
        local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
        return MotionState(
            upper.root_m, local, np.zeros(self._model.n_pose), wearer.factors, wearer.information
        )

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

    def _velocity(self, fit: Fit, last: MotionState, dt_s: float, changed: Sequence[str]) -> Floats:
        """Of the pose (n_pose,) per second, from the step since the last one; not of parts that changed over."""
        p, state = self.params, fit.state
        before, now = (last.root_m, last.local_xyzw), (state.root_m, state.local_xyzw)
        velocity = step_between(self._model, now, before) / dt_s
        velocity[:3] = np.clip(velocity[:3], -p.fastest_m_s, p.fastest_m_s)
        velocity[3:] = np.clip(velocity[3:], -p.fastest_rad_s, p.fastest_rad_s)
        for side in SIDES:
            # what is hardly seen is hardly known to move
            trust = np.clip((fit.confirmed_arms[side] - 0.15) / p.arm_trust, 0.0, 1.0)
            columns = self._arm_columns[side]
            glide = p.hidden_arm_glide * last.velocity[columns]
            velocity[columns] = trust * velocity[columns] + (1.0 - trust) * glide
        for part in changed:
            velocity[slice(None) if part == WHOLE else self._model.space.columns(part)] = 0.0
        return velocity

    def _start(self, wearer: _Wearer, frames: FrameSet) -> tuple[_Memory | None, list[View]]:
        """Look for somebody who stands before the background."""
        found = self._find.look(wearer.factors, wearer.information, frames.t_ns)
        self.probe("start")
        if found is None:
            return None, []
        fit, names = found
        self._cameras.mark_body(fit.state)
        self._cameras.doubt_background()
        self._learn_first(fit.state)
        return _Memory(frames.t_ns, fit.state, fit, names), []

    def _take_over(
        self, near: BodyState, wearer: _Wearer, frames: FrameSet
    ) -> tuple[_Memory | None, list[View]]:
        """Begin from another tracker's body, if the pictures have its outline: what is beside it is the background."""
        pose = near.pose
        if pose is None or abs(frames.t_ns - near.t_ns) > nanoseconds(_TOO_OLD_S):
            return None, []
        local = local_from_global(self._skeleton, pose.quats_xyzw)
        still = np.zeros(self._model.n_pose)
        there = MotionState(pose.root_m.copy(), local, still, wearer.factors, wearer.information)
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
            there, views, _TAKEN_OVER_S, self.params.fit.iterations, learn_shape=False,
            terms=self._terms(there, views, frames),
        )  # fmt: skip
        if not self._believed(fit):
            return None, []
        return _Memory(frames.t_ns, fit.state, fit, self._names(views)), views

    def _believed(self, fit: Fit) -> bool:
        """Whether enough of the body agrees with the pictures."""
        p = self.params
        # every second pixel was counted
        return fit.explained >= p.live_explained and 2.0 * fit.matched.sum() >= p.least_body_px

    def _learn(self, seen: _Memory | None, views: Sequence[View], nobody: bool, every: int) -> None:
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

    def _bones(self, parts: Sequence[str]) -> tuple[int, ...]:
        if WHOLE in parts:
            return tuple(range(N_JOINTS))
        return tuple(INDEX[bone] for part in parts for bone in self._model.space.parts[part].joints)

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
        away_s = seconds(frames.t_ns - known.t_ns)
        told = told_pose(
            self._fitter, known.state, known.fit, None, away_s, self.params.prediction_damping
        )
        confidence = joint_confidence(known.fit, len(known.cameras), told.uncertainty_m, away_s)
        jumped = self._bones(known.changed) if away_s == 0.0 else ()
        self._told = steadied(
            told.pose, confidence, frames.t_ns, self._told, self.params.steadying, jumped
        )
        joints_m = joint_positions(skeleton_of(shape), self._told.pose)
        evidence, roi_px = self._cameras.evidence(views)
        body = BodyState(
            t_ns=frames.t_ns,
            tracking=tracking,
            tracker=self.name,
            pose=self._told.pose,
            joints_m=joints_m,
            confidence=confidence,
            cameras=known.cameras if away_s == 0.0 else (),
            uncertainty_m=behind(grown(told.uncertainty_m, away_s), joints_m, told.joints_m),
        )
        return Track(body, shape, known.fit.explained * faded(away_s), evidence, roi_px)


def _with(known: _Memory, wearer: _Wearer) -> _Memory:
    """What is carried on, of a wearer as known to whoever steps the tracker."""
    return replace(
        known,
        state=replace(known.state, factors=wearer.factors, information=wearer.information),
    )
