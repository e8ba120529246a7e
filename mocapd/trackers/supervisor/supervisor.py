"""The supervisor's step machine: step those whose turn it is, judge, choose, join, glide; keep the others warm."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

from mocapd.body.shape import BodyShape, skeleton_of
from mocapd.clock import nanoseconds
from mocapd.each import Aside, at_once
from mocapd.trackers import steadying
from mocapd.trackers.base import GuidedTracker, Probe, Track, Tracker, lost_body, unprobed
from mocapd.trackers.lost_reason import LostReason
from mocapd.trackers.steadying import Told
from mocapd.trackers.supervisor.choice import Claim, chosen
from mocapd.trackers.supervisor.gliding import Glider, Sourced
from mocapd.trackers.supervisor.joining import apart_m, joined, placed
from mocapd.trackers.supervisor.kinds import Kind
from mocapd.trackers.supervisor.params import Params
from mocapd.trackers.supervisor.standby import (
    Standby,
    compared,
    offered,
    overrules,
    stepped,
    wants_offer,
)
from mocapd.trackers.supervisor.standing import TrackerStanding, is_well, judged
from mocapd.trackers.supervisor.steady_arms import with_steady_arms
from mocapd.types import BodyState, FrameSet, Skeleton, Tracking

PREPARED = "prepared"  # the stage in which one who is led is waited for
GLIDE = "glide"  # the stage of a frame that is told between one speaker's body and the next one's


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """A tracker that can run, and what it is good for."""

    tracker: Tracker
    kind: Kind

    @property
    def name(self) -> str:
        return self.tracker.name


@dataclass(slots=True, eq=False)
class _Known:
    """Of one candidate. track: the last one; now: whether it is of this frame set; guided: whether another's upper
    body led to it; has_offer: it was offered a body that it has not looked for yet; live_since_ns: when it began to have
    one, None while it has none; known_since_ns: likewise, also of one that coasts; told: its body as it was told last."""

    track: Track | None = None
    now: bool = False
    guided: bool = False
    has_offer: bool = False
    live_since_ns: int | None = None
    known_since_ns: int | None = None
    told: Told | None = None
    standing: TrackerStanding = field(default_factory=TrackerStanding)
    standby: Standby = field(default_factory=Standby)

    @property
    def live(self) -> bool:
        return self.now and self.track is not None and self.track.body.tracking is Tracking.LIVE

    def is_well(self, cameras: int, kind: Kind) -> bool:
        """Whether its track is one to be believed, of a frame set of so many cameras."""
        return self.now and self.track is not None and is_well(self.track, cameras, kind)

    @property
    def body(self) -> BodyState | None:
        """Of this frame set; None when it is lost, or was not asked."""
        if not self.now or self.track is None or self.track.body.pose is None:
            return None
        return self.track.body


class Supervisor:
    """Several trackers as one; see `mocapd.trackers.base.Tracker` for the promises. A body says who spoke: one
    tracker's name, or two as in colour+flex; a lost one is the supervisor's own."""

    name = "auto"

    def __init__(
        self,
        candidates: Sequence[Candidate],
        params: Params | None = None,
        aside: Aside = at_once,
    ) -> None:
        """candidates: the one to be preferred first; at least one. aside: what one of them can do before another leads it."""
        self.params = params if params is not None else Params()
        self.probe: Probe = unprobed
        self.candidates = tuple(candidates)
        # asked once: whether a class keeps a protocol takes a while
        self._guided = {
            one.name: one.tracker
            for one in self.candidates
            if isinstance(one.tracker, GuidedTracker)
        }
        self._aside, self._prepared = aside, dict[str, Callable[[], None]]()
        self._glider = Glider(self.params)
        for one in self.candidates:
            one.tracker.probe = partial(self._heard, one.name)
        steadying.rehearse()
        self.reset()

    def reset(self, near: BodyState | None = None) -> None:
        """See Tracker. near: offered to all of them."""
        for one in self.candidates:
            one.tracker.reset(near)
        self._known = {one.name: _Known() for one in self.candidates}
        self._speaker: str | None = None
        self._is_completed = False  # what was told last, by another than who spoke
        self._glider.reset(near)

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        """See Tracker. Raises ConfigError as its trackers do."""
        self._begin_aside(frames)
        try:
            return self._step(frames, shape)
        finally:
            for name in tuple(self._prepared):
                self._prepared.pop(name)()

    def _step(self, frames: FrameSet, shape: BodyShape) -> Track:
        """With what was begun aside."""
        before = self._bodies()
        for known in self._known.values():
            known.now = False
        shape = self._ask(frames, shape, lambda one: self._is_due(one, frames.t_ns))
        if self._speaker is not None and self._known[self._speaker].body is None:
            shape = self._ask(frames, shape, lambda one: not self._known[one.name].now)
        skeleton = skeleton_of(shape)
        self._speaker = self._choose(frames)
        if self._speaker is None:
            self._glider.reset()
            self._is_completed = False
            return Track(lost_body(frames.t_ns, self.name), shape, lost_reason=self._lost_reason())
        track, now = (
            self._known[self._speaker].track,
            self._composed(self._heard_of(before, frames.t_ns), skeleton),
        )
        assert track is not None
        assert now is not None
        self._is_completed = now.body.tracker != self._speaker
        self._mind_the_others(now.body, frames)
        is_new = self._glider.is_new(now)
        was = self._composed(before, skeleton) if is_new else None
        body, glides = self._glider.step(now, was, skeleton)
        self.probe(GLIDE if glides else "join")
        return replace(track, body=body, shape=shape)

    # --- stages ---

    def _begin_aside(self, frames: FrameSet) -> None:
        """Who was led in the last frame set, and so may be again, need not wait for who leads."""
        for one in self.candidates:
            guided = self._guided.get(one.name)
            if (
                guided is not None
                and self._known[one.name].guided
                and self._is_due(one, frames.t_ns)
            ):
                self._prepared[one.name] = self._aside(partial(guided.prepare, frames))

    def _ask(
        self, frames: FrameSet, shape: BodyShape, asked: Callable[[Candidate], bool]
    ) -> BodyShape:
        """Step some of them; the shape as known after that."""
        for one in self.candidates:
            if asked(one):
                shape = self._step_one(one, frames, shape)
        return shape

    def _is_due(self, one: Candidate, t_ns: int) -> bool:
        """Whether it is stepped: who speaks, who completes that, who may take over now; others now and then, but all
        while nobody is believed."""
        if not self._is_believed(self._speaker) or one.name == self._speaker or one is self._lower:
            return True
        assert self._speaker is not None
        known = self._known[one.name]
        is_preferred = self._rank(one.name) < self._rank(self._speaker)
        was_live = known.track is not None and known.track.body.tracking is Tracking.LIVE
        return (is_preferred and was_live) or t_ns >= known.standby.next_ns

    def _step_one(self, one: Candidate, frames: FrameSet, shape: BodyShape) -> BodyShape:
        """The shape as known after it."""
        known, tracker = self._known[one.name], one.tracker
        # who was offered a body looks for it whole, once
        upper = None if known.has_offer else self._guide(one)
        prepared = self._prepared.pop(one.name, None)
        if prepared is not None:
            prepared()
            self._heard(one.name, PREPARED)
        guided = self._guided.get(one.name)
        known.guided = upper is not None and guided is not None
        if upper is not None and guided is not None:
            track = guided.step_guided(frames, shape, upper)
        else:
            track = tracker.step(frames, shape)
        if one.kind.upper_only:
            steadying = self.params.steadying
            track, known.told = with_steady_arms(track, track.shape, known.told, steadying)
        known.track, known.now, known.has_offer = track, True, False
        if known.body is None:
            known.known_since_ns = None
        elif known.known_since_ns is None:
            known.known_since_ns = frames.t_ns
        if not known.live:
            known.live_since_ns = None
        elif known.live_since_ns is None:
            known.live_since_ns = frames.t_ns
        known.standing = judged(known.standing, track, len(frames.frames), one.kind, self.params)
        known.standby = stepped(known.standby, frames.t_ns, self.params)
        return track.shape

    def _guide(self, one: Candidate) -> BodyState | None:
        """The upper body that leads this candidate in this frame, as another that comes before it sees it."""
        if one.kind.upper_only:
            return None
        for other in self.candidates:
            known = self._known[other.name]
            leads = other.kind.upper_only and self._speaker in (None, other.name)
            if leads and known.live and known.track and known.track.quality >= other.kind.poor:
                return known.body
        return None

    def _choose(self, frames: FrameSet) -> str | None:
        told = None if self._speaker is None else self._known[self._speaker].body
        claims = []
        for one in self.candidates:
            known = self._known[one.name]
            near = told is None or self._is_near(known.body, told)
            may_begin = self._speaker is not None or self._has_arrived(one, frames.t_ns)
            claims.append(
                Claim(
                    one.name,
                    believed=known.standing.believed,
                    known=known.body is not None,
                    live=known.live and may_begin,
                    well=known.is_well(len(frames.frames), one.kind) and may_begin,
                    agrees=near or overrules(known.standby, frames.t_ns, self.params),
                )
            )
        return chosen(self._speaker, claims)

    def _has_arrived(self, one: Candidate, t_ns: int) -> bool:
        """Whether the body that this one knows is no first look at somebody who is still walking in, whom a tracker that is
        preferred to it may know better a moment later."""
        since = self._known[one.name].live_since_ns
        is_first = self._rank(one.name) == 0
        return since is not None and (is_first or t_ns - since >= nanoseconds(self.params.arrive_s))

    def _bodies(self) -> dict[str, Sourced]:
        """Those of this frame set, and whose: a tracker that is guided is another one."""
        return {
            name: Sourced(known.body, f"guided {name}" if known.guided else name)
            for name, known in self._known.items()
            if known.body is not None
        }

    def _heard_of(self, before: Mapping[str, Sourced], t_ns: int) -> dict[str, Sourced]:
        """The bodies of this frame set, without one that completes who spoke before and was not there until a moment ago:
        how it moves is not known yet, and what is told must go over to it."""
        bodies = self._bodies()
        lower = self._lower
        if (
            lower is not None
            and self._speaker in before
            and lower.name != self._speaker
            and not (self._is_completed and lower.name in before)
            and self._is_first_look(lower, t_ns)
        ):
            bodies.pop(lower.name, None)
        return bodies

    def _is_first_look(self, lower: Candidate, t_ns: int) -> bool:
        since = self._known[lower.name].known_since_ns
        return since is not None and t_ns - since < nanoseconds(self.params.arrive_s)

    def _composed(self, bodies: Mapping[str, Sourced], skeleton: Skeleton) -> Sourced | None:
        """The body of who speaks, of those of one frame set, completed where it is an upper body alone."""
        assert self._speaker is not None
        upper = bodies.get(self._speaker)
        if upper is None:
            return None
        is_upper = self.candidates[self._rank(self._speaker)].kind.upper_only
        lower = bodies.get(self._lower.name) if self._lower is not None and is_upper else None
        if lower is None or apart_m(upper.body, lower.body) > self.params.near_m:
            return Sourced(placed(upper.body, skeleton), upper.source)
        both = joined(upper.body, lower.body, skeleton)
        return Sourced(both, f"{upper.source}+{lower.source}")

    def _mind_the_others(self, told: BodyState, frames: FrameSet) -> None:
        """Who does not speak is compared with what is told, and offered that when it went astray."""
        t_ns = frames.t_ns
        is_sure = told.tracking is Tracking.LIVE and self._is_believed(self._speaker)
        for one in self.candidates:
            known = self._known[one.name]
            if one.name == self._speaker:
                known.standby = Standby(next_offer_ns=known.standby.next_offer_ns)
            elif known.now:
                near = self._is_near(known.body, told)
                standby = compared(known.standby, t_ns, self.params, live=known.live, near=near)
                can_begin = len(frames.frames) >= one.kind.least_cameras
                if is_sure and can_begin and wants_offer(standby, t_ns, self.params):
                    one.tracker.reset(near=told)
                    standby, known.has_offer = offered(standby, t_ns, self.params), True
                known.standby = standby

    def _lost_reason(self) -> LostReason | None:
        """What the first of them says that can tell."""
        tracks = [known.track for known in self._known.values() if known.now]
        reasons = [track.lost_reason for track in tracks if track is not None]
        return next((one for one in reasons if one is not None), None)

    # --- who is who ---

    @property
    def _lower(self) -> Candidate | None:
        """Who completes an upper body."""
        return next((one for one in self.candidates if not one.kind.upper_only), None)

    def _rank(self, name: str) -> int:
        return next(i for i, one in enumerate(self.candidates) if one.name == name)

    def _is_near(self, one: BodyState | None, other: BodyState) -> bool:
        return one is not None and apart_m(one, other) <= self.params.near_m

    def _is_believed(self, name: str | None) -> bool:
        return name is not None and self._known[name].standing.believed

    def _heard(self, tracker: str, stage: str) -> None:
        self.probe(f"{tracker}.{stage}")
