"""A tracker's step that takes too long: told after a moment, and the end of the process when it never ends.

Meanwhile the newest frames wait and older ones are dropped. A thread that computes cannot be ended from outside: what
is left is to end the process, so that whoever started it (systemd, a user) starts it again.
"""

import logging

from mocapd.errors import MocapdError

_log = logging.getLogger(__name__)

SLOW_S = 1.0  # told from then on: thirty times what a step may take [s]


class StuckStepError(MocapdError):
    """A tracker computes on one frame set without end (70 EX_SOFTWARE)."""


class StepWatch:
    """Looks at how long the step that runs has taken. For one thread."""

    def __init__(self, stuck_s: float) -> None:
        """stuck_s: after so long a step is held to never end [s]."""
        self._stuck_s = stuck_s
        self._longest_s = 0.0  # of a step that is told of
        self.detail = ""  # what people should know now

    def look(self, step_s: float) -> None:
        """step_s: since the step that runs began; 0 where none does. Raises StuckStepError."""
        if step_s >= self._stuck_s:
            raise StuckStepError(
                f"the tracker has worked on one picture for {step_s:.0f} s",
                "the tracker",
                "it is started again by systemd, or by you; where the machine is just slow: tracker.stuck_s",
            )
        if step_s < SLOW_S:
            if self._longest_s:
                _log.info("the tracker goes on, after %.1f s", self._longest_s)
            self._longest_s, self.detail = 0.0, ""
            return
        if not self._longest_s:
            _log.warning(
                "the tracker takes long for one picture; those that come meanwhile are dropped"
            )
        self._longest_s = step_s
        self.detail = f"the tracker has worked on one picture for {step_s:.0f} s"
