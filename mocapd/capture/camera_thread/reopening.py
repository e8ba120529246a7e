"""When a lost camera is opened again: after a pause that grows, and only so many times before it is left out."""

from collections import deque
from dataclasses import dataclass, field

from mocapd.clock import nanoseconds
from mocapd.errors import CameraLost, MocapdError


@dataclass(frozen=True, slots=True)
class BackOff:
    """The pause before opening a lost camera again: `first_s`, doubled each time up to `longest_s`."""

    first_s: float = 0.1
    longest_s: float = 5.0

    def pause_s(self, failures: int) -> float:
        """The pause [s] after that many failures in a row (1 or more)."""
        return min(self.longest_s, self.first_s * 2.0 ** min(failures - 1, 30))


@dataclass(slots=True)
class RestartBudget:
    """How often a camera that delivers may fail again before it is left alone. For one thread.

    Opening it helps nothing then, takes its bus and fills the log: it rests for `rest_s`, or until somebody
    plugs it in anew. That a camera is not there at all costs nothing.
    """

    most: int = 6
    within_s: float = 60.0
    rest_s: float = 300.0
    _spent_ns: deque[int] = field(default_factory=deque)

    def spend(self, now_ns: int) -> bool:
        """It failed again after it had delivered; whether the budget is spent by that."""
        self._spent_ns.append(now_ns)
        while now_ns - self._spent_ns[0] > nanoseconds(self.within_s):
            self._spent_ns.popleft()
        return len(self._spent_ns) > self.most

    def left_out(self, error: MocapdError, has_plug: bool) -> CameraLost:
        """What is told of it then. error: its last; has_plug: whether it may be plugged in anew."""
        return CameraLost(
            f"left out for {self.rest_s:.0f} s, as it failed {self.most + 1} times within {self.within_s:.0f} s: "
            f"{error.what}",
            fix="plug it in again, into a port of another USB controller or without a hub"
            if has_plug
            else error.fix,
        )

    def renew(self) -> None:
        """It was plugged in anew, or has rested."""
        self._spent_ns.clear()
