"""The step machine: predict, observe, solve, judge the cues, learn, and publish one body."""

from collections.abc import Iterable
from dataclasses import dataclass

from mocapd.body.model import build_model
from mocapd.body.pose_space import full_body
from mocapd.body.shape import BodyShape
from mocapd.body.skeleton import standard_skeleton
from mocapd.clock import nanoseconds, seconds
from mocapd.each import Each, in_turn
from mocapd.errors import ConfigError
from mocapd.fit.motion_state import MotionState, predict_state, shape_prior, update_shape
from mocapd.tracking.base import Probe, Track, lost_body, require_stature, unprobed
from mocapd.tracking.cue_trust import CLOTHES_TRUST, SHIRT_TRUST, CueTrust
from mocapd.tracking.cues.base import Cue
from mocapd.tracking.cues.clothes.clothes_cue import ClothesCue
from mocapd.tracking.cues.clothes.clothes_fits import ClothesFound, Observed
from mocapd.tracking.cues.shirt.shirt_cue import ShirtCue, ShirtFound
from mocapd.tracking.cues.shirt.shirt_watch import ShirtWatch
from mocapd.tracking.effort import WORK, Effort
from mocapd.tracking.initialisers.base import Begun, Initialiser
from mocapd.tracking.initialisers.given_body import GivenBody
from mocapd.tracking.initialisers.person_before_background import PersonBeforeBackground
from mocapd.tracking.initialisers.shirt_pose import ShirtPose
from mocapd.tracking.pictures import Pictures
from mocapd.tracking.pose_filter import PoseFilter
from mocapd.tracking.published_body import CueFindings, published_body
from mocapd.tracking.ticks import TickClock
from mocapd.tracking.track_state import Proportions, TrackState
from mocapd.tracking.tracking_state import TrackingState, TrackingStateParams
from mocapd.tracking.trunk_and_legs import joined, with_still_legs, with_upper
from mocapd.types import BodyState, FrameSet, Rig, Tracking

_TOO_OLD_S = 1.0  # a pose is not predicted from any longer; a busy machine may skip many frames


@dataclass(frozen=True, slots=True)
class BodyTrackerParams:
    """Times are of the frames, never counted in them [s]."""

    work_width_px: int = 320  # of pictures averaged down, about
    damping: float = 0.6  # of the motion that a prediction goes on with
    arrive_s: float = 0.15  # clothes alone begin no sooner where the shirt may: first looks at who walks in are the worst
    overrule_s: float = 2.0  # the shirt seen elsewhere for so long is right
    legs_last_s: float = 0.5  # legs that are not seen are published for so long


class BodyTracker:
    """A person whom one camera or more see in the shirt, or two and more in any clothes; see `tracking.base.Tracker` for the
    promises. A body says which cues carry it: `shirt`, `clothes`, or both."""

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
        """name: of the profile; one of the cues at least; each: of the cameras."""
        self.name = name
        self.params = p = params if params is not None else BodyTrackerParams()
        self.probe: Probe = unprobed
        self._stature_m, self._skeleton = stature_m, standard_skeleton(stature_m)
        self.rig, self._shirt, self._clothes = rig, shirt, clothes
        self._pictures = Pictures(rig.cameras, p.work_width_px, each)
        self._model = clothes.model if clothes else build_model(stature_m, full_body())
        self._watch = ShirtWatch(shirt, self._model, p.damping) if shirt is not None else None
        self._tracking, self._filter = TrackingState(tracking), PoseFilter()
        self._cues: tuple[Cue, ...] = tuple(one for one in (clothes, shirt) if one is not None)
        self._given = GivenBody(self._model, self._skeleton, shirt, clothes, _TOO_OLD_S)
        self._initialisers: list[Initialiser] = [self._given]
        if self._watch is not None:
            self._initialisers.append(ShirtPose(self._watch))
        if clothes is not None:
            self._initialisers.append(PersonBeforeBackground(clothes))
        self._filter.rehearse(self._skeleton)
        for cue in self._cues:
            cue.rehearse()
        self.reset()

    def reset(self, near: BodyState | None = None) -> None:
        """See Tracker."""
        for one in (*self._cues, self._watch, self._filter):
            if one is not None:
                one.reset()
        self._given.give(near)
        self._tracking.reset(None if self._given.body is None else self._given.body.t_ns)
        self._known: TrackState | None = None
        self._shirt_trust, self._clothes_trust = CueTrust(), CueTrust()
        self._begun_ns, self._ticks = 0, TickClock()

    @property
    def clothes(self) -> ClothesCue | None:
        """The cue of any clothes, where the profile has it."""
        return self._clothes

    def set_effort(self, effort: Effort) -> None:
        """See EffortTracker."""
        for cue in self._cues:
            cue.work = WORK[effort]

    def learn_room(self, frames: Iterable[FrameSet]) -> None:
        """See `RoomLearner`. Raises ConfigError as `step` does, and where no cue looks at clothes."""
        if self._clothes is None:
            raise ConfigError(
                f"the tracker {self.name!r} learns no room", "--room", "leave it out, or add --tracker markerless"
            )  # fmt: skip
        self._clothes.learn_room(frames, self._pictures)

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        """See Tracker. Raises ConfigError when a frame's size is not its calibration's."""
        require_stature(shape, self._stature_m)
        self._ticks.pass_to(frames.t_ns)
        present = self._look(frames)
        self.probe("picture")
        wearer = Proportions(*shape_prior(shape, full_body()), shape.taught_s)
        now, found = self._recent(frames.t_ns), CueFindings()
        if present:
            if now is not None:
                now, found = self._follow(now.of(wearer), wearer, present, frames)
            else:
                now, found = self._begin(wearer, present, frames)
        is_seen = now is not None and now.t_ns == frames.t_ns
        tracking = self._tracking.step(
            frames.t_ns, is_seen and not self._is_arriving(now, frames.t_ns)
        )
        if tracking is Tracking.LOST and not is_seen:
            now = None
        self._known = now
        self._learn(found, present)
        self.probe("learn")
        if now is not None and self._shirt is not None:
            n = self._shirt.model.n_shape
            shape = update_shape(
                shape, now.motion.factors[:n], now.motion.information[:n, :n], now.taught_s
            )
        if tracking is Tracking.LOST or now is None:
            self._filter.reset()
            reason = self._clothes.lost_reason(frames.t_ns) if self._clothes is not None else None
            return Track(lost_body(frames.t_ns, self.name), shape, lost_reason=reason)
        motion = now.motion
        if not is_seen:
            motion = predict_state(
                self._model, motion, self._coasts_s(now, frames.t_ns), self.params.damping
            )
        track = published_body(
            now, motion, found, self._shirt, self._clothes, self._filter, frames.t_ns, tracking, shape
        )  # fmt: skip
        self.probe("publish")
        return track

    # --- stages ---

    def _look(self, frames: FrameSet) -> dict[int, float]:
        """Each seeing camera's own time after the frame set's [s], by index."""
        present = self._pictures.look(frames)
        for cue in self._cues:
            cue.take(self._pictures, self._ticks.now)
        return present

    def _recent(self, t_ns: int) -> TrackState | None:
        """Who is known, unless that is too old to predict from."""
        known = self._known
        return None if known is None or t_ns - known.t_ns > nanoseconds(_TOO_OLD_S) else known

    def _follow(
        self, known: TrackState, wearer: Proportions, present: dict[int, float], frames: FrameSet
    ) -> tuple[TrackState, CueFindings]:
        """One frame of tracking; one without evidence leaves `known` at its old time."""
        t_ns, clothes, watch = frames.t_ns, self._clothes, self._watch
        dt_s = max(seconds(t_ns - known.t_ns), 1e-3)
        predicted = predict_state(self._model, known.motion, dt_s, self.params.damping)
        seen = trunk = whole = other = None
        if clothes is not None:
            seen = clothes.observe(predicted, t_ns, known.legs_since_ns, known.by_shirt)
            self.probe("clothes.observe")
        if watch is not None:
            trunk = watch.see(
                known,
                predicted,
                wearer,
                dt_s,
                present,
                frames,
                self._ticks.now.turn,
                self._shirt_trust.believed,
                self.probe,
            )
            if watch.has_looked:
                quality = None if trunk is None else trunk.fit.explained
                self._shirt_trust = self._shirt_trust.judged(
                    t_ns, quality, len(present), SHIRT_TRUST
                )
            other = watch.elsewhere
        if trunk is not None and watch is not None and self._carries(known, t_ns):
            if other is None:
                return self._carried(known, predicted, trunk, seen, dt_s, frames)
            watch.reset()
            return self._carried(other, other.motion, trunk, None, dt_s, frames)
        if clothes is not None and seen is not None:
            whole = clothes.whole(known, seen, dt_s, frames, self.probe)
        self._judge_clothes(whole, t_ns, len(present))
        trunk = None if other is not None else trunk
        if whole is None and trunk is not None:
            return self._carried(known, predicted, trunk, seen, dt_s, frames)
        if whole is None:
            return known, CueFindings()
        since_ns = t_ns if known.legs_since_ns is None else known.legs_since_ns
        state = TrackState(
            t_ns, whole.motion, whole.cameras, trunk.fit if trunk else None, whole.fit, t_ns, since_ns, whole.changed,
            known.taught_s,
        )  # fmt: skip
        return state, CueFindings(trunk, whole)

    def _carries(self, known: TrackState, t_ns: int) -> bool:
        """Whether the shirt, which is seen, carries trunk and arms in this frame."""
        shirt, clothes = self._shirt_trust, self._clothes_trust
        if self._clothes is None or self._watch is None:
            return True
        if known.by_shirt:
            return shirt.believed or shirt.well or not clothes.believed
        if self._watch.elsewhere is not None and clothes.believed:
            elsewhere_ns = t_ns - self._watch.elsewhere_since_ns
            return shirt.believed and elsewhere_ns >= nanoseconds(self.params.overrule_s)
        return shirt.believed or (shirt.well and not clothes.believed)

    def _carried(
        self,
        known: TrackState,
        predicted: MotionState,
        trunk: ShirtFound,
        seen: Observed | None,
        dt_s: float,
        frames: FrameSet,
    ) -> tuple[TrackState, CueFindings]:
        """Trunk and arms by the shirt, legs and head by the clothes."""
        assert self._shirt is not None
        t_ns, clothes = frames.t_ns, self._clothes
        start, below = with_upper(predicted, trunk.motion), None
        if clothes is not None:
            below = clothes.below(known, start, seen, dt_s, frames, self.probe)
            self._judge_clothes(below, t_ns, len(clothes.cameras.present))
        names, changed = self._shirt.names(trunk.views), tuple(f"{s}_arm" for s in trunk.jumped)
        if below is None:
            motion = with_still_legs(start, known.motion, len(trunk.motion.velocity))
            lasts = t_ns - known.whole_ns <= nanoseconds(self.params.legs_last_s)
            whole, whole_ns = known.whole if lasts else None, known.whole_ns
            since_ns = known.legs_since_ns if whole is not None else None
        else:
            motion = joined(below.motion, trunk.motion)
            whole, whole_ns = below.fit, t_ns
            since_ns = t_ns if known.legs_since_ns is None else known.legs_since_ns
            names, changed = (*names, *below.cameras), (*changed, *below.changed)
        state = TrackState(
            t_ns, motion, tuple(dict.fromkeys(names)), trunk.fit, whole, whole_ns, since_ns, changed, trunk.taught_s,
            by_shirt=True,
        )  # fmt: skip
        return state, CueFindings(trunk, below)

    def _begin(
        self, wearer: Proportions, present: dict[int, float], frames: FrameSet
    ) -> tuple[TrackState | None, CueFindings]:
        """Look for somebody: where they were known, in the shirt, before the background."""
        was_given = self._given.body is not None
        for one in self._initialisers:
            found = one.find(wearer, present, frames, self._ticks.now.turn)
            self.probe(one.name)
            if found is not None:
                return self._begun(found, frames)
            if was_given and one is self._given:
                self._tracking.reset()
        return None, CueFindings()

    def _begun(self, found: Begun, frames: FrameSet) -> tuple[TrackState, CueFindings]:
        t_ns = self._begun_ns = frames.t_ns
        known, whole = TrackState(t_ns, found.body, ()), found.whole
        if whole is not None:
            known = TrackState(t_ns, whole.motion, whole.cameras, None, whole.fit, t_ns, t_ns)
        if found.trunk is None:
            return known, CueFindings(None, whole)
        return self._carried(known, known.motion, found.trunk, None, 1e-3, frames)

    def _is_arriving(self, now: TrackState | None, t_ns: int) -> bool:
        """Whether this is a first look at somebody whom the shirt may know better a moment later."""
        if (
            now is None
            or now.by_shirt
            or self._shirt is None
            or self._tracking.now is not Tracking.LOST
        ):
            return False
        return t_ns - self._begun_ns < nanoseconds(self.params.arrive_s)

    def _judge_clothes(self, found: ClothesFound | None, t_ns: int, cameras: int) -> None:
        quality = None if found is None else found.fit.explained
        self._clothes_trust = self._clothes_trust.judged(t_ns, quality, cameras, CLOTHES_TRUST)

    def _learn(self, found: CueFindings, present: dict[int, float]) -> None:
        """What each cue learns of a frame in which it saw the body."""
        known, clothes = self._known, self._clothes
        if self._shirt is not None:
            self._shirt.learn(found.shirt, present, known is None)
        if clothes is not None:
            clothes.learn(found.clothes, known is None, known is not None and known.by_shirt)

    def _coasts_s(self, known: TrackState, t_ns: int) -> float:
        """How far a body that is not seen goes on [s]: then it stays."""
        return min(seconds(t_ns - known.t_ns), 0.1)
