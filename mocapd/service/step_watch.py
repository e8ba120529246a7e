"""Watchdog of the tracker's step: logs a slow step, ends the process when a step hangs.

Meanwhile the newest frames wait and older ones are dropped. A computing thread cannot be ended from outside, so the
process ends and systemd or the user restarts it.
"""

import logging

from mocapd.errors import MocapdError

_log = logging.getLogger(__name__)

SLOW_S = 1.0  # log threshold: thirty times a step's budget [s]


class StuckStepError(MocapdError):
    """A tracker hangs in one frame set (70 EX_SOFTWARE)."""


class StepWatch:
    """Checks the duration of the current step. Not thread-safe."""

    def __init__(self, stuck_s: float) -> None:
        """stuck_s: after so long a step counts as hanging [s]."""
        self._stuck_s = stuck_s
        self._longest_s = 0.0  # of a logged step
        self.detail = ""  # the trouble, for users

    def look(self, step_s: float) -> None:
        """step_s: duration of the current step; 0 between steps. Raises StuckStepError."""
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
