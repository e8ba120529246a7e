"""Detects the daemon's progress by its work, never by elapsed time. Pure."""

from mocapd.capture.camera_thread.capture_status import CaptureState
from mocapd.service.service import Snapshot


class ProgressWatch:
    """Progress means: the pipeline completed a turn, outputs included, and every live camera delivered.

    Without frames the pipeline turns twice a second, so an empty room or unplugged cameras are no stall. Stalls are a
    tracker that does not return, an output that blocks, and a live camera without frames.
    """

    def __init__(self) -> None:
        self._turns = 0
        self._frames: dict[str, int] = {}

    def has_progressed(self, snapshot: Snapshot) -> bool:
        """True if there was progress since the last call that returned True."""
        # compared by inequality: another session restarts the counters
        turned = snapshot.metrics.turns != self._turns
        live = {n: s for n, s in snapshot.cameras.items() if s.state is CaptureState.LIVE}
        delivered = all(self._frames.get(name) != status.frames for name, status in live.items())
        if not (turned and delivered):
            return False
        self._turns = snapshot.metrics.turns
        self._frames = {name: status.frames for name, status in live.items()}
        return True
