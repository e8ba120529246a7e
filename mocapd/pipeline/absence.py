"""Bodies to publish while no camera delivers: the last pose coasts with falling confidence, then `lost`. Pure."""

from collections import deque
from dataclasses import replace

import numpy as np

from mocapd.clock import NS_PER_S, nanoseconds, seconds
from mocapd.tracking.tracking_state import confidence_fade, grow_uncertainty
from mocapd.types import BodyState, Tracking

COASTING_EVERY_NS = NS_PER_S // 10
LOST_EVERY_NS = NS_PER_S
FIRST_NS = 3 * NS_PER_S  # grace time for opening the cameras

_PERIODS = 4  # frame intervals until the timeout
_SOONEST_NS = 150_000_000  # limits of the timeout
_LATEST_NS = NS_PER_S  # also the timeout before the first interval
_REMEMBERED = 8  # intervals; the longest counts, so that a falling rate causes no timeout


class Absence:
    """A timeout on frames. A tracker steps on frames only, so without frames its own coasting stands still.

    Call `begin` once, `came` with every body of frames, and `next_body` when `due_ns` has passed: it gives the body to
    publish. Published times strictly rise.
    """

    def __init__(self, tracker: str, n_joints: int, coast_s: float) -> None:
        """coast_s: how long after the last evidence a pose is still published [s]."""
        self.due_ns: int | None = None  # by the clock; None before `begin`
        self._no_person = BodyState(0, Tracking.LOST, tracker, None, None, np.zeros(n_joints))
        self._coast_ns = nanoseconds(coast_s)
        self._last: BodyState | None = None  # of frames
        self._came_ns = 0  # by the clock
        self._evidence_ns = 0  # the time of the last body with evidence
        self._sent_ns = 0  # the time of the last body, of frames or not
        self._intervals_ns: deque[int] = deque(maxlen=_REMEMBERED)

    def begin(self, now_ns: int) -> None:
        """Start to expect frames."""
        self.due_ns = now_ns + FIRST_NS

    def came(self, body: BodyState, now_ns: int) -> BodyState:
        """The body of frames to publish; its time is raised where it is not after the last published one."""
        if self._last is not None:
            interval_ns = now_ns - self._came_ns
            if interval_ns <= _LATEST_NS:  # a longer one is an outage, not a rate
                self._intervals_ns.append(interval_ns)
        self._last, self._came_ns = body, now_ns
        if body.tracking is Tracking.LIVE:
            self._evidence_ns = body.t_ns
        self.due_ns = now_ns + self._timeout_ns()
        if body.t_ns <= self._sent_ns:
            body = replace(body, t_ns=self._sent_ns + 1)
        self._sent_ns = body.t_ns
        return body

    def next_body(self, now_ns: int) -> BodyState | None:
        """The body to publish at `now_ns`; None before `due_ns`."""
        if self.due_ns is None or now_ns < self.due_ns:
            return None
        last = self._last
        if last is None:
            body = replace(self._no_person, t_ns=now_ns)
        else:
            # with the cameras' last delay
            t_ns = max(last.t_ns + now_ns - self._came_ns, self._sent_ns + 1)
            body = self._coasting(last, t_ns) or replace(self._no_person, t_ns=t_ns)
        lost = body.tracking is Tracking.LOST
        self.due_ns = now_ns + (LOST_EVERY_NS if lost else COASTING_EVERY_NS)
        self._sent_ns = body.t_ns
        return body

    def _coasting(self, last: BodyState, t_ns: int) -> BodyState | None:
        """The last pose with its confidence faded; None when it is too old, or there was none."""
        if last.tracking is Tracking.LOST or t_ns - self._evidence_ns > self._coast_ns:
            return None
        away_s = seconds(t_ns - last.t_ns)
        return replace(
            last,
            t_ns=t_ns,
            tracking=Tracking.COASTING,
            confidence=last.confidence * confidence_fade(away_s),
            cameras=(),
            uncertainty_m=grow_uncertainty(last.uncertainty_m, away_s),
        )

    def _timeout_ns(self) -> int:
        longest_ns = max(self._intervals_ns, default=_LATEST_NS)
        return min(max(_PERIODS * longest_ns, _SOONEST_NS), _LATEST_NS)
