"""The colour tracker's step machine: predict, classify, fit, judge, learn; or look for the shirt anew."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from mocapd.body.model import N_POSE, N_SHAPE, build_model, shape_of
from mocapd.body.shape import skeleton_of
from mocapd.body.shirt import standard_shirt
from mocapd.body.skeleton import N_JOINTS
from mocapd.clock import nanoseconds, seconds
from mocapd.errors import ConfigError
from mocapd.geometry import rotations
from mocapd.trackers.colour import detection
from mocapd.trackers.colour.arms import SIDES, ArmSearch, confirmed, doubtful
from mocapd.trackers.colour.confidence import joint_confidence
from mocapd.trackers.colour.database import PoseDatabase
from mocapd.trackers.colour.drawing import Roi
from mocapd.trackers.colour.fitting import Fit, Fitter, View
from mocapd.trackers.colour.motion_state import (
    MotionState,
    initial_information,
    moved,
    step_between,
)
from mocapd.trackers.colour.params import Params
from mocapd.trackers.colour.segmentation import Eye
from mocapd.trackers.tracking_state import TrackingState, TrackingStateParams
from mocapd.types import (
    BodyState,
    Floats,
    Frame,
    FrameSet,
    Ints,
    Pose,
    Rig,
    Skeleton,
    Track,
    Tracking,
)
from mocapd.vision.colour_model import ColourModel

_TICK_S = 1.0 / 30.0
_TOO_OLD_S = 1.0  # a pose is not predicted from any longer; a busy machine may skip many frames
_ARM_STEPS = {"left": slice(9, 18), "right": slice(18, 27)}  # of the pose parameters
_PATCHES = {"left": slice(9, 15), "right": slice(15, 21)}


@dataclass(frozen=True, slots=True, eq=False)
class _Known:
    """What is carried from frame to frame while somebody is tracked."""

    t_ns: int
    state: MotionState
    fit: Fit | None
    taught_s: float  # seconds of good tracking that the body shape was learned from
    cameras: tuple[str, ...]


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
    ) -> None:
        """white_balance: W (3,3) by camera name, from strokes in the present light; identity where absent."""
        self.params = p = params if params is not None else Params()
        self.rig, self._database = rig, database
        model = build_model(stature_m)
        factors = [max(1, round(c.size_px[0] / p.work_width_px)) for c in rig.cameras]
        # portrait and odd sizes: keep the work picture within the buffers
        factors = [
            max(f, -(-max(c.size_px) // 480)) for f, c in zip(factors, rig.cameras, strict=True)
        ]
        self._fitter = Fitter(model, rig.cameras, factors, p)
        self._eyes = [
            Eye(c, f, colour_model, np.asarray(white_balance.get(c.name, np.eye(3))), p)
            for c, f in zip(rig.cameras, factors, strict=True)
        ]
        self._index = {camera.name: i for i, camera in enumerate(rig.cameras)}
        self._arms = ArmSearch(self._fitter, p)
        self._tracking = TrackingState(tracking)
        self.probe: Callable[[str], None] = _silent
        self._rehearse()
        self.reset()

    def _rehearse(self) -> None:
        """Compile or load the kernels that only rare frames reach."""
        eye = self._eyes[0]
        w, h = eye.size
        nothing = np.zeros((h, w), np.uint8)
        rest = self._fitter.model.rest_m
        state = MotionState(
            rest[0].copy(),
            np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1)),
            np.zeros(N_POSE),
            np.ones(N_SHAPE),
            initial_information(),
        )
        self._arms.rehearse(state, [View(0, (0, 0, w, h), nothing, nothing, 0.0)])

    @property
    def skeleton(self) -> Skeleton:
        """The wearer's skeleton as estimated so far."""
        factors = self._known.state.factors if self._known else self._factors
        return skeleton_of(shape_of(self._fitter.model, factors))

    def reset(self) -> None:
        """Forget pose, proportions, light and background."""
        for eye in self._eyes:
            eye.reset()
        self._tracking.reset()
        self._known: _Known | None = None
        self._factors: Floats = np.ones(N_SHAPE)
        self._information: Floats = initial_information()
        self._taught_s = 0.0
        self._next_search_ns = 0
        self._turn = 0
        self._redraw = True

    def step(self, frames: FrameSet) -> Track:
        """Track one frame set. Raises ConfigError when a frame's size is not its calibration's."""
        self._turn += 1
        present = self._look(frames)
        self.probe("picture")
        known = self._known
        if known is not None and frames.t_ns - known.t_ns > nanoseconds(_TOO_OLD_S):
            known = None  # too old to predict from
        views: list[View] = []
        if known is not None and present:
            known, views = self._follow(known, present, frames)
        if present and frames.t_ns >= self._next_search_ns and self._doubtful(known, frames.t_ns):
            known, views = self._search(known, views, present, frames)
            self.probe("detect")
        evidence = known is not None and known.t_ns == frames.t_ns
        tracking = self._tracking.step(frames.t_ns, evidence)
        if tracking is Tracking.LOST and not evidence:
            known = None
        self._known = known
        if known is not None:
            self._factors, self._information = known.state.factors, known.state.information
            self._taught_s = known.taught_s
        self._learn(views, known if evidence else None, present)
        self.probe("learn")
        return self._track(tracking, frames, views)

    # --- stages ---

    def _look(self, frames: FrameSet) -> dict[int, float]:
        """Take the pictures; per camera present, its own time after the set's [s]."""
        mine = sorted((self._index[n], f) for n, f in frames.frames.items() if n in self._index)
        for i, frame in mine:
            _check_size(frame, self.rig.cameras[i].size_px)
            self._eyes[i].look(frame.pixels)
        return {i: seconds(frame.t_ns - frames.t_ns) for i, frame in mine}

    def _views(
        self, state: MotionState, present: dict[int, float], doubted: tuple[str, ...], relight: bool
    ) -> list[View]:
        """Classify every picture with the state as prior."""
        p = self.params
        margin = p.doubt_margin_px if doubted else p.margin_px
        colours = _colours_of(doubted)
        views = []
        for i, dt_s in present.items():
            drawing = self._fitter.drawings[i]
            roi = drawing.region(state, dt_s, margin)
            if roi is None:
                continue
            predicted = drawing.render(state, dt_s, roi)
            ids, softness = self._eyes[i].classify(
                predicted, drawing.outline(), roi, colours, relight
            )
            views.append(View(i, roi, ids, softness, dt_s))
        return views

    def _follow(
        self, known: _Known, present: dict[int, float], frames: FrameSet
    ) -> tuple[_Known, list[View]]:
        """One frame of tracking; a frame without evidence leaves `known` at its old time."""
        p, fitter = self.params, self._fitter
        last = known.state
        dt_s = max(seconds(frames.t_ns - known.t_ns), 1e-3)
        root, local = moved(fitter.model, last, dt_s, p.prediction_damping)
        predicted = replace(last, root_m=root, local_xyzw=local)
        doubted = tuple(s for s in SIDES if known.fit is not None and doubtful(s, known.fit, p))
        views = self._views(predicted, present, doubted, relight=True)
        self.probe("classify")
        if not views:
            return known, views
        learning = (
            p.learn_shape
            and known.taught_s < p.shape_learning_s
            and known.fit is not None
            and _match(known.fit) > p.shape_match
        )
        fit = fitter.fit(predicted, views, dt_s, p.iterations, learning, rendered=True)
        self.probe("fit")
        before = fit
        fit, switched = self._arms.improve(fit, views, dt_s, self._turn, learning)
        self._redraw = fit is not before or any(doubtful(s, before, p) for s in SIDES)
        self.probe("arms")
        match = _match(fit)
        # every second pixel was counted
        if match < p.live_match or 2.0 * fit.matched.sum() < p.min_shirt_px:
            return known, views
        state, taught_s = fit.state, known.taught_s
        if learning and match > p.shape_match:
            gained = fitter.shape_information(fit.H) * (p.shape_gain * dt_s / _TICK_S)
            state = replace(state, information=state.information + gained)
            taught_s += dt_s
        velocity = step_between(
            fitter.model, (state.root_m, state.local_xyzw), (last.root_m, last.local_xyzw)
        )
        velocity /= dt_s
        velocity[:3] = np.clip(velocity[:3], -p.fastest_m_s, p.fastest_m_s)
        velocity[3:] = np.clip(velocity[3:], -p.fastest_rad_s, p.fastest_rad_s)
        velocity = p.velocity_memory * last.velocity + (1.0 - p.velocity_memory) * velocity
        for side in SIDES:
            # what is hardly seen is hardly known to move; what was changed over jumped
            trust = np.clip((confirmed(side, fit) - 0.15) / p.arm_trust, 0.0, 1.0)
            velocity[_ARM_STEPS[side]] *= 0.0 if side in switched else trust
        names = tuple(self.rig.cameras[v.index].name for v in views)
        return _Known(frames.t_ns, replace(state, velocity=velocity), fit, taught_s, names), views

    def _doubtful(self, known: _Known | None, t_ns: int) -> bool:
        """Whether to look for the wearer anew: nobody is known, or what is known agrees badly."""
        if known is None or known.fit is None or known.t_ns != t_ns:
            return True
        return _match(known.fit) < self.params.doubt_match

    def _search(
        self,
        known: _Known | None,
        views: list[View],
        present: dict[int, float],
        frames: FrameSet,
    ) -> tuple[_Known | None, list[View]]:
        """Look for the wearer from nothing; what is already known stands unless something better is found."""
        p = self.params
        pause_s = p.search_pause_s if known is None else p.doubt_pause_s
        self._next_search_ns = frames.t_ns + nanoseconds(pause_s)
        before = [eye.memory.appearance for eye in self._eyes]
        views = [replace(v, ids=v.ids.copy(), softness=v.softness.copy()) for v in views]
        found = self._found(present)
        if found is not None:
            fit, seen = found
            held = known.fit if known is not None and known.t_ns == frames.t_ns else None
            if held is None or _match(fit) > _match(held) + p.doubt_gain:
                self._next_search_ns = frames.t_ns
                names = tuple(self.rig.cameras[v.index].name for v in seen)
                return _Known(frames.t_ns, fit.state, fit, self._taught_s, names), seen
        for eye, appearance in zip(self._eyes, before, strict=True):
            eye.memory.appearance = appearance
        return known, views

    def _found(self, present: dict[int, float]) -> tuple[Fit, list[View]] | None:
        """An acceptable fit from the pose database, and the views it was fitted to."""
        p = self.params
        sightings = [
            s
            for i in present
            if (s := detection.sight(i, self._eyes[i], self._database, p)) is not None
        ]
        states = detection.hypotheses(
            sightings, self.rig.cameras, self._database, self._factors, self._information
        )
        flat = [
            View(
                s.index, s.found.roi, s.found.ids,
                np.full(s.found.ids.shape, int(255 * p.soft_unknown), np.uint8), present[s.index],
            )
            for s in sightings
        ]  # fmt: skip
        fit = detection.best_fit(self._fitter, states, flat)
        self._redraw = True
        if fit is None:
            return None
        for s in sightings:
            self._eyes[s.index].relight(s.found.W)
        # read the pictures again, now with the pose as prior, and fit once more
        views = self._views(fit.state, present, (), relight=True)
        if not views:
            return None
        fit = self._fitter.fit(fit.state, views, 0.1, p.iterations, learn_shape=False)
        fit, _ = self._arms.improve(fit, views, 0.1, self._turn, learn_shape=False)
        return (fit, views) if self._acceptable(fit) else None

    def _acceptable(self, fit: Fit) -> bool:
        """Whether a pose found from nothing is the shirt: enough agrees, in enough colours."""
        p = self.params
        match = fit.matched.sum() / max(fit.visible.sum() + fit.unexplained.sum(), 1.0)
        confirmed = (fit.matched >= 4.0) & (fit.matched >= 0.4 * fit.visible)
        colours = np.unique(standard_shirt().colour_of_patch[np.flatnonzero(confirmed)])
        return bool(
            match >= p.accept_match
            and np.count_nonzero(colours) >= p.accept_colours
            and 2.0 * fit.matched.sum() >= p.min_shirt_px
        )

    def _learn(self, views: list[View], known: _Known | None, present: dict[int, float]) -> None:
        """Follow light and background in every camera that has a frame."""
        seen = {v.index: v for v in views}
        for i in present:
            eye, drawing, view = self._eyes[i], self._fitter.drawings[i], seen.get(i)
            if known is not None and view is not None and known.fit is not None:
                if self._redraw:
                    final = drawing.render(known.state, view.dt_s, view.roi)
                else:  # the last iteration's drawing differs by a fraction of a pixel
                    final = drawing.last(view.roi)[0]
                sure = _match(known.fit) > self.params.sure_match
                eye.mark_body(final, view.roi)
                eye.learn(final, view.ids, view.softness, view.roi, _TICK_S, sure)
            elif self._known is None:
                eye.mark_body(None, (0, 0, 0, 0))
            eye.learn_background()

    # --- result ---

    def _track(self, tracking: Tracking, frames: FrameSet, views: list[View]) -> Track:
        known = self._known
        if tracking is Tracking.LOST or known is None:
            nobody = BodyState(
                frames.t_ns, Tracking.LOST, self.name, None, None, np.zeros(N_JOINTS)
            )
            return Track(nobody)
        state = known.state
        away_s = seconds(frames.t_ns - known.t_ns)
        if away_s > 0.0:  # coasting: it moves on for a moment, then stays
            root, local = moved(
                self._fitter.model, state, min(away_s, 0.1), self.params.prediction_damping
            )
            state = replace(state, root_m=root, local_xyzw=local)
        joints, globals_ = self._fitter.joints(state)
        confidence = joint_confidence(known.fit, len(known.cameras), away_s)
        body = BodyState(
            t_ns=frames.t_ns,
            tracking=tracking,
            tracker=self.name,
            pose=Pose(joints[0], np.where(globals_[:, 3:] < 0, -globals_, globals_)),
            joints_m=joints,
            confidence=confidence,
            cameras=known.cameras if away_s == 0.0 else (),
        )
        return Track(
            body,
            evidence={self.rig.cameras[v.index].name: v.ids.copy() for v in views},
            roi_px={self.rig.cameras[v.index].name: self._frame_roi(v) for v in views},
        )

    def _frame_roi(self, view: View) -> Roi:
        """A view's region in pixels of the frame itself."""
        factor = self._eyes[view.index].factor
        x0, y0, x1, y1 = (factor * edge for edge in view.roi)
        return x0, y0, x1, y1


def _colours_of(sides: tuple[str, ...]) -> Ints:
    """The colours (0..9) of the sleeves in doubt."""
    if not sides:
        return np.empty(0, np.int64)
    colours = [standard_shirt().colour_of_patch[_PATCHES[side]] for side in sides]
    return np.unique(np.concatenate(colours)).astype(np.int64) - 1


def _match(fit: Fit) -> float:
    """Share of the rendered shirt whose colour the pictures have."""
    return float(fit.matched.sum() / max(fit.visible.sum(), 1.0))


def _check_size(frame: Frame, size_px: tuple[int, int]) -> None:
    h, w = frame.pixels.shape[:2]
    if (w, h) != size_px:
        raise ConfigError(
            f"delivers {w}x{h}, its calibration is for {size_px[0]}x{size_px[1]}",
            f"camera {frame.camera!r}",
            "set that size, or calibrate again",
        )


def _silent(stage: str) -> None:
    """No stopwatch."""
