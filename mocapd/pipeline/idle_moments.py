"""Moments after a frame set while no other waits, in which other threads disturb the pipeline least."""

import threading

LONGEST_S = 0.04  # one comes after each frame set, if the machine is fast enough


class IdleMoments:
    """The pipeline's thread calls `begin`, other threads wait for it."""

    def __init__(self) -> None:
        self._begun = threading.Condition()

    def begin(self) -> None:
        """Wakes who waits: the pipeline has nothing to do until the next frame set."""
        with self._begun:
            self._begun.notify_all()

    def wait(self, timeout_s: float = LONGEST_S) -> None:
        """Returns when such a moment begins, or after so long: a pipeline that is always busy has none."""
        with self._begun:
            self._begun.wait(timeout_s)
