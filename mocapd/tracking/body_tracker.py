"""The per-frame state machine: predict, observe, solve, update cue trust, publish one body; then learn."""

from collections.abc import Iterable
from dataclasses import dataclass

from mocapd.body.model import build_model
from mocapd.body.pose_space import full_body
from mocapd.body.shape import BodyShape
from mocapd.body.skeleton import standard_skeleton
from mocapd.clock import nanoseconds, seconds
from mocapd.each import Each, in_turn
from mocapd.errors import ConfigError
from mocapd.fit.motion_state import MotionState, shape_prior, update_shape
from mocapd.tracking.base import Probe, Track, lost_body, no_probe, require_stature
from mocapd.tracking.cue_trust import CLOTHES_TRUST, SHIRT_TRUST, CueTrust
from mocapd.tracking.cues.base import Cue
from mocapd.tracking.cues.clothes.clothes_cue import ClothesCue
from mocapd.tracking.cues.clothes.clothes_solver import ClothesEstimate, ClothesObservation
from mocapd.tracking.cues.shirt.shirt_cue import ShirtCue, ShirtEstimate
from mocapd.tracking.cues.shirt.shirt_locator import ShirtLocator
from mocapd.tracking.effort import WORK, Effort
from mocapd.tracking.initialisers.base import (
    ForegroundPerson,
    HandedOverBody,
    Initialiser,
    InitialPose,
    ShirtPose,
)
from mocapd.tracking.pictures import Pictures
from mocapd.tracking.pose_filter import PoseFilter
from mocapd.tracking.published_body import CueEstimates, publish_body
from mocapd.tracking.ticks import TickClock
from mocapd.tracking.track_state import BodyShapeEstimate, TrackState
from mocapd.tracking.tracking_state import TrackingState, TrackingStateParams
from mocapd.tracking.trunk_and_legs import freeze_legs, join_bodies, replace_upper_body
from mocapd.types import BodyState, Floats, FrameSet, Rig, Tracking

_MAX_STATE_AGE_S = 1.0  # an older state predicts nothing; a busy machine may skip many frames


@dataclass(frozen=True, slots=True)
class BodyTrackerParams:
    """Durations are seconds of frame time."""

    work_width_px: int = 320  # approximate width of the downscaled pictures
    damping: float = 0.6  # share of its velocity that a prediction keeps
    arrive_s: float = 0.15  # a profile with a shirt publishes clothes-only tracks no younger: early fits are the worst
    # a shirt tracked elsewhere for this long replaces the body of the clothes
    overrule_s: float = 2.0
    legs_last_s: float = 0.5  # unobserved legs are published for this long


class BodyTracker:
    """Tracks one person with the shirt (one camera or more) or any clothes (two or more); see `tracking.base.Tracker`. With
    one camera, clothes follow legs and head below the shirt.

    `BodyState.tracker` names the cues that carry the body: `shirt`, `clothes` or both.
    """

    def __init__(
        self,
        name: str,
        rig: Rig,
        stature_m: float,
        shirt: ShirtCue | None,
        clothes: ClothesCue | None,
        params: BodyTrackerParams | None = None,
        tracking: TrackingStateParams | None = None,
        each: Each = in_turn,
    ) -> None:
        """name: of the profile; at least one cue is required; each: runs work for each camera."""
        self.name = name
        self.params = p = params if params is not None else BodyTrackerParams()
        self.probe: Probe = no_probe
        self._stature_m, self._skeleton = stature_m, standard_skeleton(stature_m)
        self.rig, self._shirt, self._clothes = rig, shirt, clothes
        self._pictures = Pictures(rig.cameras, p.work_width_px, each)
        self._model = clothes.model if clothes else build_model(stature_m, full_body())
        self._locator = ShirtLocator(shirt, self._model, p.damping) if shirt is not None else None
        self._tracking, self._filter = TrackingState(tracking), PoseFilter()
        self._cues: tuple[Cue, ...] = tuple(cue for cue in (clothes, shirt) if cue is not None)
        self._handed_over = HandedOverBody(
            self._model, self._skeleton, shirt, clothes, _MAX_STATE_AGE_S
        )
        self._initialisers: list[Initialiser] = [self._handed_over]
        if self._locator is not None:
            self._initialisers.append(ShirtPose(self._locator))
        if clothes is not None and clothes.alone:
            self._initialisers.append(ForegroundPerson(clothes))
        self._filter.rehearse(self._skeleton)
        for cue in self._cues:
            cue.rehearse()
        self.reset()

    def reset(self, near: BodyState | None = None) -> None:
        """See Tracker."""
        for part in (*self._cues, self._locator, self._filter):
            if part is not None:
                part.reset()
        self._handed_over.set_body(near)
        body = self._handed_over.body
        self._tracking.reset(None if body is None else body.t_ns)
        self._state: TrackState | None = None
        # estimates, present cameras, and whether the body was observed, of the newest frame set
        self._unlearned: tuple[CueEstimates, dict[int, float], bool] | None = None
        self._shirt_trust, self._clothes_trust = CueTrust(), CueTrust()
        self._track_start_ns, self._ticks = 0, TickClock()

    @property
    def clothes(self) -> ClothesCue | None:
        """The clothes cue, if the profile has it."""
        return self._clothes

    def set_effort(self, effort: Effort) -> None:
        """See EffortTracker."""
        for cue in self._cues:
            cue.work = WORK[effort]

    def learn_room(self, frames: Iterable[FrameSet]) -> None:
        """See `RoomLearner`. Raises ConfigError as `step` does, and for a profile without clothes."""
        if self._clothes is None:
            raise ConfigError(
                f"the tracker {self.name!r} learns no room", "--room", "leave it out, or add --tracker markerless"
            )  # fmt: skip
        self._clothes.learn_room(frames, self._pictures)

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        """See Tracker. Raises ConfigError when a frame's size is not its calibration's."""
        require_stature(shape, self._stature_m)
        self.learn()
        self._ticks.pass_to(frames.t_ns)
        present = self._load(frames)
        self.probe("picture")
        wearer = BodyShapeEstimate(*shape_prior(shape, full_body()), shape.taught_s)
        state, estimates = self._recent_state(frames.t_ns), CueEstimates()
        if present:
            if state is not None:
                state, estimates = self._track(
                    state.with_shape(wearer), wearer, present, frames.t_ns
                )
            else:
                state, estimates = self._initialise(wearer, present, frames)
        is_observed = state is not None and state.t_ns == frames.t_ns
        tracking = self._tracking.step(
            frames.t_ns, is_observed and not self._is_too_young(state, frames.t_ns)
        )
        if tracking is Tracking.LOST and not is_observed:
            state = None
        self._state, self._unlearned = state, (estimates, present, is_observed)
        if state is not None and self._shirt is not None:
            n, motion = self._shirt.model.n_shape, state.motion
            shape = update_shape(
                shape, motion.factors[:n], motion.information[:n, :n], state.taught_s
            )
        if tracking is Tracking.LOST or state is None:
            self._filter.reset()
            reason = self._clothes.lost_reason(frames.t_ns) if self._clothes is not None else None
            return Track(lost_body(frames.t_ns, self.name), shape, lost_reason=reason)
        motion = state.motion
        if not is_observed:
            coast_s = _coast_s(state, frames.t_ns)
            motion = state.predicted(self._model, coast_s, self.params.damping)
        track = publish_body(
            state, motion, estimates, self._shirt, self._clothes, self._filter, frames.t_ns, tracking, shape
        )  # fmt: skip
        self.probe("publish")
        return track

    def learn(self, is_late: bool = False) -> None:
        """See LearningTracker. Detects keypoints for the next frame set, and updates each cue's background, light and colours
        from its estimate."""
        if self._unlearned is None:
            return
        (estimates, present, is_observed), self._unlearned = self._unlearned, None
        state, clothes = self._state, self._clothes
        if self._shirt is not None:
            self._shirt.learn(estimates.shirt, present, state is None)
        if clothes is not None:
            if state is not None and state.by_shirt and is_observed:
                clothes.detect_keypoints(state.motion, state.t_ns, state.legs_since_ns, is_late)
                self.probe("keypoints")
            clothes.learn(estimates.clothes, state is None, state is not None and state.by_shirt)
        self.probe("learn")

    # --- stages ---

    def _load(self, frames: FrameSet) -> dict[int, float]:
        """Passes the pictures to the cues. Returns each present camera's time offset from the frame set [s], by index."""
        present = self._pictures.load(frames)
        for cue in self._cues:
            cue.take(self._pictures, self._ticks.now)
        return present

    def _recent_state(self, t_ns: int) -> TrackState | None:
        """The track state, unless it is too old to predict from."""
        state, max_age_ns = self._state, nanoseconds(_MAX_STATE_AGE_S)
        return None if state is None or t_ns - state.t_ns > max_age_ns else state

    def _track(
        self,
        state: TrackState,
        wearer: BodyShapeEstimate,
        present: dict[int, float],
        t_ns: int,
    ) -> tuple[TrackState, CueEstimates]:
        """The state after this frame set. Without evidence it is the old state, with its old time."""
        clothes, locator = self._clothes, self._locator
        dt_s = max(seconds(t_ns - state.t_ns), 1e-3)
        predicted = state.predicted(self._model, dt_s, self.params.damping)
        observed = trunk = whole = separate = None
        if clothes is not None:
            observed = clothes.observe(predicted, t_ns, state.legs_since_ns, state.by_shirt)
            self.probe("clothes.observe")
        if locator is not None:
            trunk = locator.locate(
                state,
                predicted,
                wearer,
                dt_s,
                present,
                t_ns,
                self._ticks.now.frame_index,
                self._shirt_trust.trusted,
                () if observed is None else observed.joints,
                self.probe,
            )
            if locator.has_searched:
                quality = None if trunk is None else trunk.fit.explained
                self._shirt_trust = self._shirt_trust.update(
                    t_ns, quality, len(present), SHIRT_TRUST
                )
            separate = locator.separate_track
        if trunk is not None and locator is not None and self._shirt_carries(state, t_ns):
            if separate is None:
                return self._solve_by_shirt(state, predicted, trunk, observed, dt_s, t_ns)
            locator.reset()
            return self._solve_by_shirt(separate, separate.motion, trunk, None, dt_s, t_ns)
        if clothes is not None and clothes.alone and clothes.legs_rest:
            observed = clothes.observe(predicted, t_ns, state.legs_since_ns, False)
        if clothes is not None and clothes.alone and observed is not None:
            whole = clothes.fit_whole_body(state, observed, dt_s, self.probe)
        self._update_clothes_trust(whole, t_ns, len(clothes.cameras.present) if clothes else 0)
        trunk = None if separate is not None else trunk
        if whole is None and trunk is not None:
            return self._solve_by_shirt(state, predicted, trunk, observed, dt_s, t_ns)
        if whole is None:
            return state, CueEstimates()
        since_ns = t_ns if state.legs_since_ns is None else state.legs_since_ns
        updated = TrackState(
            t_ns, whole.motion, whole.cameras, trunk.fit if trunk else None, whole.fit, t_ns, since_ns, whole.changed,
            state.taught_s, off_keypoints_m=_newest_off_m(state, whole),
        )  # fmt: skip
        return updated, CueEstimates(trunk, whole)

    def _shirt_carries(self, state: TrackState, t_ns: int) -> bool:
        """True if the shirt, which is visible, places trunk and arms in this frame set."""
        shirt, clothes = self._shirt_trust, self._clothes_trust
        if self._clothes is None or not self._clothes.alone or self._locator is None:
            return True
        if state.by_shirt:
            return shirt.trusted or shirt.is_good or not clothes.trusted
        if self._locator.separate_track is not None and clothes.trusted:
            separate_ns = t_ns - self._locator.separate_since_ns
            return shirt.trusted and separate_ns >= nanoseconds(self.params.overrule_s)
        return shirt.trusted or (shirt.is_good and not clothes.trusted)

    def _solve_by_shirt(
        self,
        state: TrackState,
        predicted: MotionState,
        trunk: ShirtEstimate,
        observed: ClothesObservation | None,
        dt_s: float,
        t_ns: int,
    ) -> tuple[TrackState, CueEstimates]:
        """Combines trunk and arms of the shirt with legs and head of the clothes."""
        assert self._shirt is not None
        clothes = self._clothes
        start, lower = replace_upper_body(predicted, trunk.motion), None
        if clothes is not None:
            lower = clothes.fit_lower_body(state, start, observed, dt_s, self.probe)
            self._update_clothes_trust(lower, t_ns, len(clothes.cameras.present))
        names, changed = self._shirt.names(trunk.views), tuple(f"{s}_arm" for s in trunk.jumped)
        if lower is None:
            motion = freeze_legs(start, state.motion, len(trunk.motion.velocity))
            is_recent = t_ns - state.whole_ns <= nanoseconds(self.params.legs_last_s)
            whole, whole_ns = state.whole if is_recent else None, state.whole_ns
            since_ns = state.legs_since_ns if whole is not None else None
        else:
            motion = join_bodies(lower.motion, trunk.motion, lower.line_of_sight)
            whole, whole_ns = lower.fit, t_ns
            since_ns = t_ns if state.legs_since_ns is None else state.legs_since_ns
            names, changed = (*names, *lower.cameras), (*changed, *lower.changed)
        updated = TrackState(
            t_ns, motion, tuple(dict.fromkeys(names)), trunk.fit, whole, whole_ns, since_ns, changed, trunk.taught_s,
            by_shirt=True, off_keypoints_m=_newest_off_m(state, lower),
        )  # fmt: skip
        return updated, CueEstimates(trunk, lower)

    def _initialise(
        self, wearer: BodyShapeEstimate, present: dict[int, float], frames: FrameSet
    ) -> tuple[TrackState | None, CueEstimates]:
        """Runs the initialisers in order: handed-over body, shirt, foreground person."""
        had_handover = self._handed_over.body is not None
        for initialiser in self._initialisers:
            pose = initialiser.find(wearer, present, frames, self._ticks.now.frame_index)
            self.probe(initialiser.name)
            if pose is not None:
                return self._start_track(pose, frames.t_ns)
            if had_handover and initialiser is self._handed_over:
                self._tracking.reset()
        return None, CueEstimates()

    def _start_track(self, pose: InitialPose, t_ns: int) -> tuple[TrackState, CueEstimates]:
        self._track_start_ns = t_ns
        state, whole = TrackState(t_ns, pose.body, ()), pose.whole
        if whole is not None:
            state = TrackState(t_ns, whole.motion, whole.cameras, None, whole.fit, t_ns, t_ns)
        if pose.trunk is None:
            return state, CueEstimates(None, whole)
        return self._solve_by_shirt(state, state.motion, pose.trunk, None, 1e-3, t_ns)

    def _is_too_young(self, state: TrackState | None, t_ns: int) -> bool:
        """True for a new clothes-only track younger than `arrive_s`: the shirt may give a better pose a moment later."""
        if (
            state is None
            or state.by_shirt
            or self._shirt is None
            or self._tracking.now is not Tracking.LOST
        ):
            return False
        return t_ns - self._track_start_ns < nanoseconds(self.params.arrive_s)

    def _update_clothes_trust(
        self, estimate: ClothesEstimate | None, t_ns: int, cameras: int
    ) -> None:
        quality = None if estimate is None else estimate.fit.explained
        self._clothes_trust = self._clothes_trust.update(t_ns, quality, cameras, CLOTHES_TRUST)


def _coast_s(state: TrackState, t_ns: int) -> float:
    """For how long an unobserved body is extrapolated [s]; it then stands still."""
    return min(seconds(t_ns - state.t_ns), 0.1)


def _newest_off_m(state: TrackState, found: ClothesEstimate | None) -> Floats | None:
    """Of this frame set if it has keypoints, otherwise of the last one that had."""
    newest = None if found is None else found.off_keypoints_m
    return state.off_keypoints_m if newest is None else newest
