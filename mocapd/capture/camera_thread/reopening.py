"""Policy of reopening a lost camera: exponential backoff, and quarantine after repeated failures."""

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
    """Limits how often a camera may fail after it delivered frames. Not thread-safe.

    Beyond the limit reopening only loads the USB bus and the log: the camera is quarantined for `rest_s` or until
    it is plugged in again. An absent camera does not use the budget.
    """

    most: int = 6
    within_s: float = 60.0
    rest_s: float = 300.0
    _spent_ns: deque[int] = field(default_factory=deque)

    def spend(self, now_ns: int) -> bool:
        """Counts a failure of a camera that had delivered; True if the budget is exhausted."""
        self._spent_ns.append(now_ns)
        while now_ns - self._spent_ns[0] > nanoseconds(self.within_s):
            self._spent_ns.popleft()
        return len(self._spent_ns) > self.most

    def quarantine_error(self, error: MocapdError, has_plug: bool) -> CameraLost:
        """The error of a quarantined camera. error: its last one; has_plug: whether replugging may help."""
        return CameraLost(
            f"left out for {self.rest_s:.0f} s, as it failed {self.most + 1} times within {self.within_s:.0f} s: "
            f"{error.what}",
            fix="plug it in again, into a port of another USB controller or without a hub"
            if has_plug
            else error.fix,
        )

    def renew(self) -> None:
        """Restores the budget, after a replug."""
        self._spent_ns.clear()
