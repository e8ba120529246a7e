"""The colour tracker's step machine: predict, classify, fit, judge, learn; or look for the shirt anew."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from mocapd.body.model import build_model
from mocapd.body.pose_space import SIDES
from mocapd.body.shape import BodyShape
from mocapd.body.skeleton import N_JOINTS, local_from_global, standard_skeleton
from mocapd.clock import nanoseconds, seconds
from mocapd.each import Each, in_turn
from mocapd.fit.body_drawing import image_scales
from mocapd.fit.fit_params import TICK_S
from mocapd.fit.limbs.arm_search import ArmSearch, is_uncertain
from mocapd.fit.motion_prior import predicted_information
from mocapd.fit.motion_state import (
    MotionState,
    gone_on,
    initial_information,
    known_of,
    learned,
)
from mocapd.fit.solver import Fit, Fitter, View
from mocapd.geometry import rotations
from mocapd.shirt.colour.colour_model import ColourModel
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.shirt.segmentation.rig_segmenter import RigSegmenter
from mocapd.trackers.base import Probe, Track, lost_body, require_stature, unprobed
from mocapd.trackers.blending import Residual, later, residual_of
from mocapd.trackers.colour import detection
from mocapd.trackers.colour.confidence import joint_confidence
from mocapd.trackers.colour.params import Params
from mocapd.trackers.texture_distance import texture_distances
from mocapd.trackers.told_pose import told_pose
from mocapd.trackers.tracking_state import TrackingState, TrackingStateParams, faded, grown
from mocapd.trackers.velocity import velocity_between
from mocapd.types import (
    BodyState,
    Floats,
    FrameSet,
    Rig,
    Tracking,
)

_TAKEN_OVER_S = 0.1  # another tracker's body is held as loosely as a prediction over this time
_TOO_OLD_S = 1.0  # a pose is not predicted from any longer; a busy machine may skip many frames


@dataclass(frozen=True, slots=True, eq=False)
class _Memory:
    """What is carried from frame to frame while somebody is tracked."""

    t_ns: int
    state: MotionState
    fit: Fit
    taught_s: float  # seconds of good tracking that the body shape was learned from
    cameras: tuple[str, ...]
    left: Residual | None = None  # of what was shown wrongly before


@dataclass(frozen=True, slots=True, eq=False)
class _Wearer:
    """The proportions as handed in, in the tracker's space."""

    factors: Floats
    information: Floats
    taught_s: float


class ColourTracker:
    """One to N cameras see a person in the shirt; see `mocapd.trackers.base.Tracker` for the promises."""

    name = "colour"

    def __init__(
        self,
        rig: Rig,
        stature_m: float,
        colour_model: ColourModel,
        white_balance: Mapping[str, Floats],
        database: PoseDatabase,
        params: Params | None = None,
        tracking: TrackingStateParams | None = None,
        each: Each = in_turn,
    ) -> None:
        """white_balance: W (3,3) by camera name, from strokes in the present light; identity where absent. each: of the
        cameras."""
        self.params = p = params if params is not None else Params()
        self.rig, self._database = rig, database
        model = build_model(stature_m)
        smaller = image_scales(rig.cameras, p.fit.work_width_px)
        self._fitter = Fitter(model, rig.cameras, smaller, p.fit, each)
        self._segmenters = RigSegmenter(self._fitter, colour_model, white_balance, p.segmentation)
        self._arm_columns = {side: model.space.columns(f"{side}_arm") for side in SIDES}
        self._arms = ArmSearch(self._fitter, p.limbs)
        self._tracking = TrackingState(tracking)
        self.probe: Probe = unprobed
        self._rehearse()
        self.reset()

    def _rehearse(self) -> None:
        """Compile or load the kernels that only rare frames reach."""
        w, h = self._segmenters.each[0].size
        nothing = np.zeros((h, w), np.uint8)
        model = self._fitter.model
        state = MotionState(
            model.rest_m[0].copy(),
            np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1)),
            np.zeros(model.n_pose),
            np.ones(model.n_shape),
            initial_information(model.space),
        )
        self._arms.rehearse(state, [View(0, (0, 0, w, h), nothing, nothing, 0.0)])

    def reset(self, near: BodyState | None = None) -> None:
        """Forget pose, light and background. near: a body to be looked for where it is, before everywhere."""
        self._segmenters.reset()
        self._tracking.reset(None if near is None or near.pose is None else near.t_ns)
        self._known: _Memory | None = None
        self._near = near
        self._next_search_ns = 0
        self._turn = 0
        self._redraw = True

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        """Track one frame set. Raises ConfigError when a frame's size is not its calibration's."""
        self._turn += 1
        present = self._segmenters.look(frames)
        self.probe("picture")
        require_stature(shape, self._fitter.model.stature_m)
        wearer = _Wearer(*known_of(shape, self._fitter.model.space), shape.taught_s)
        known = self._known
        if known is not None and frames.t_ns - known.t_ns > nanoseconds(_TOO_OLD_S):
            known = None  # too old to predict from
        views: list[View] = []
        if known is not None and present:
            known, views = self._follow(_with(known, wearer), present, frames)
        elif self._near is not None and present:
            known, views = self._take_over(self._near, wearer, present, frames)
            self._near = None
            if known is None:
                self._tracking.reset()
        if (
            present
            and frames.t_ns >= self._next_search_ns
            and self._is_uncertain(known, frames.t_ns)
        ):
            known, views = self._search(known, wearer, views, present, frames)
            self.probe("detect")
        evidence = known is not None and known.t_ns == frames.t_ns
        tracking = self._tracking.step(frames.t_ns, evidence)
        if tracking is Tracking.LOST and not evidence:
            known = None
        self._known = known
        if known is not None:
            shape = learned(shape, known.state.factors, known.state.information, known.taught_s)
        if known is not None and evidence:
            self._segmenters.learn_with(known.state, known.fit, views, self._redraw)
        self._segmenters.learn_background(present, nobody=known is None)
        self.probe("learn")
        return self._track(tracking, frames, views, shape)

    # --- stages ---

    def _follow(
        self, known: _Memory, present: dict[int, float], frames: FrameSet
    ) -> tuple[_Memory, list[View]]:
        """One frame of tracking; a frame without evidence leaves `known` at its old time."""
        p, fitter = self.params, self._fitter
        last = known.state
        dt_s = max(seconds(frames.t_ns - known.t_ns), 1e-3)
        predicted = gone_on(fitter.model, last, dt_s, p.prediction_damping)
        uncertain = tuple(s for s in SIDES if is_uncertain(s, known.fit, p.limbs))
        views = self._segmenters.views(predicted, present, uncertain)
        self.probe("classify")
        if not views:
            return known, views
        learning = (
            p.shape.learn
            and known.taught_s < p.shape.learning_s
            and known.fit.match > p.shape.least_match
        )
        confirmed = known.fit.confirmed_arms
        motion = predicted_information(
            known.fit.covariance, last.velocity * dt_s, dt_s / TICK_S, fitter.prediction_sd,
            [(self._arm_columns[s], min(confirmed[s] / p.limbs.uncertain_arm, 1.0)) for s in SIDES], p.motion,
        )  # fmt: skip
        terms = texture_distances(fitter, predicted, views, frames, self._turn, p.distances)
        fit = fitter.fit(
            predicted,
            views,
            dt_s,
            p.fit.iterations,
            learning,
            rendered=True,
            motion=motion,
            terms=terms,
        )
        self.probe("fit")
        before = fit
        fit, switched = self._arms.improve(fit, views, dt_s, self._turn, learning, terms)
        self._redraw = fit is not before or any(is_uncertain(s, before, p.limbs) for s in SIDES)
        self.probe("arms")
        match = fit.match
        # every second pixel was counted
        if match < p.live_match or 2.0 * fit.matched.sum() < p.min_shirt_px:
            return known, views
        state, taught_s = fit.state, known.taught_s
        if learning and match > p.shape.least_match:
            gained = fitter.shape_information(fit.H) * (p.shape.gain * dt_s / TICK_S)
            state = replace(state, information=state.information + gained)
            taught_s += dt_s
        jumped = [self._arm_columns[side] for side in switched]
        velocity = velocity_between(fitter.model, last, fit, dt_s, jumped, p.velocity)
        names = tuple(self.rig.cameras[v.index].name for v in views)
        left = later(known.left) if known.left is not None else None
        if switched:
            left = residual_of(fitter, predicted, state, known.left, p.blend_m)
        return _Memory(
            frames.t_ns, replace(state, velocity=velocity), fit, taught_s, names, left
        ), views

    def _take_over(
        self, near: BodyState, wearer: _Wearer, present: dict[int, float], frames: FrameSet
    ) -> tuple[_Memory | None, list[View]]:
        """Begin from another tracker's body, if the pictures confirm it."""
        p, pose = self.params, near.pose
        if pose is None or abs(frames.t_ns - near.t_ns) > nanoseconds(_TOO_OLD_S):
            return None, []
        local = local_from_global(standard_skeleton(self._fitter.model.stature_m), pose.quats_xyzw)
        still = np.zeros(self._fitter.model.n_pose)
        there = MotionState(pose.root_m.copy(), local, still, wearer.factors, wearer.information)
        views = self._segmenters.views(there, present)
        if not views:
            return None, []
        fit = self._fitter.fit(there, views, _TAKEN_OVER_S, p.fit.iterations, learn_shape=False)
        fit, _ = self._arms.improve(fit, views, _TAKEN_OVER_S, self._turn, learn_shape=False)
        if not self._acceptable(fit):
            return None, []
        names = tuple(self.rig.cameras[v.index].name for v in views)
        return _Memory(frames.t_ns, fit.state, fit, wearer.taught_s, names), views

    def _is_uncertain(self, known: _Memory | None, t_ns: int) -> bool:
        """Whether to look for the wearer anew: nobody is known, or what is known agrees badly."""
        if known is None or known.t_ns != t_ns:
            return True
        return known.fit.match < self.params.uncertain_match

    def _search(
        self,
        known: _Memory | None,
        wearer: _Wearer,
        views: list[View],
        present: dict[int, float],
        frames: FrameSet,
    ) -> tuple[_Memory | None, list[View]]:
        """Look for the wearer from nothing; what is already known stands unless something better is found."""
        p = self.params
        pause_s = p.search_pause_s if known is None else p.uncertain_pause_s
        self._next_search_ns = frames.t_ns + nanoseconds(pause_s)
        before = [segmenter.memory.appearance for segmenter in self._segmenters.each]
        views = [replace(v, ids=v.ids.copy(), pixel_weight=v.pixel_weight.copy()) for v in views]
        found = self._found(wearer, present)
        if found is not None:
            fit, seen = found
            held = known.fit if known is not None and known.t_ns == frames.t_ns else None
            if held is None or fit.match > held.match + p.uncertain_gain:
                self._next_search_ns = frames.t_ns
                names = tuple(self.rig.cameras[v.index].name for v in seen)
                left = None
                if known is not None:
                    left = residual_of(self._fitter, known.state, fit.state, known.left, p.blend_m)
                return _Memory(frames.t_ns, fit.state, fit, wearer.taught_s, names, left), seen
        for segmenter, appearance in zip(self._segmenters.each, before, strict=True):
            segmenter.memory.appearance = appearance
        return known, views

    def _found(self, wearer: _Wearer, present: dict[int, float]) -> tuple[Fit, list[View]] | None:
        """An acceptable fit from the pose database, and the views it was fitted to."""
        p = self.params
        sightings = [
            s
            for i in present
            if (s := detection.sight(i, self._segmenters.each[i], self._database, p.neighbours))
            is not None
        ]
        states = detection.hypotheses(
            sightings,
            self.rig.cameras,
            self._database,
            wearer.factors,
            wearer.information,
            self._fitter.model.n_pose,
        )
        flat = [
            View(
                s.index, s.found.roi, s.found.ids,
                np.full(s.found.ids.shape, int(255 * p.segmentation.soft_unknown), np.uint8), present[s.index],
            )
            for s in sightings
        ]  # fmt: skip
        fit = detection.best_fit(self._fitter, states, flat)
        self._redraw = True
        if fit is None:
            return None
        for s in sightings:
            self._segmenters.each[s.index].relight(s.found.W)
        # read the pictures again, now with the pose as prior, and fit once more
        views = self._segmenters.views(fit.state, present)
        if not views:
            return None
        fit = self._fitter.fit(fit.state, views, 0.1, p.fit.iterations, learn_shape=False)
        fit, _ = self._arms.improve(fit, views, 0.1, self._turn, learn_shape=False)
        return (fit, views) if self._acceptable(fit) else None

    def _acceptable(self, fit: Fit) -> bool:
        """Whether a pose found from nothing is the shirt: enough agrees, in enough colours."""
        p = self.params
        return bool(
            fit.explained >= p.accept_match
            and fit.confirmed_colours() >= p.accept_colours
            and 2.0 * fit.matched.sum() >= p.min_shirt_px
        )

    # --- result ---

    def _track(
        self, tracking: Tracking, frames: FrameSet, views: list[View], shape: BodyShape
    ) -> Track:
        known = self._known
        if tracking is Tracking.LOST or known is None:
            return Track(lost_body(frames.t_ns, self.name), shape)
        away_s = seconds(frames.t_ns - known.t_ns)
        told = told_pose(
            self._fitter, known.state, known.fit, known.left, away_s, self.params.prediction_damping
        )
        uncertainty_m = told.uncertainty_m
        confidence = joint_confidence(known.fit, len(known.cameras), uncertainty_m, away_s)
        body = BodyState(
            t_ns=frames.t_ns,
            tracking=tracking,
            tracker=self.name,
            pose=told.pose,
            joints_m=told.joints_m,
            confidence=confidence,
            cameras=known.cameras if away_s == 0.0 else (),
            uncertainty_m=grown(uncertainty_m, away_s),
        )
        return Track(
            body,
            shape,
            known.fit.explained * faded(away_s),
            evidence={self.rig.cameras[v.index].name: v.ids.copy() for v in views},
            roi_px={self.rig.cameras[v.index].name: self._segmenters.roi_px(v) for v in views},
        )


def _with(known: _Memory, wearer: _Wearer) -> _Memory:
    """What is carried on, of a wearer as known to whoever steps the tracker."""
    state = replace(known.state, factors=wearer.factors, information=wearer.information)
    return replace(known, state=state, taught_s=wearer.taught_s)
