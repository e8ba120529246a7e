"""Reports a running daemon to its service manager: status line and watchdog heartbeats."""

import logging

from mocapd.app.daemon.notifier import Notifier
from mocapd.capture.camera_thread.capture_status import CaptureState, CaptureStatus
from mocapd.service.service import Snapshot
from mocapd.types import Tracking

_log = logging.getLogger(__name__)


class ProgressWatch:
    """Detects the daemon's progress by its work, never by elapsed time. Pure.

    Progress means: the pipeline completed a turn, outputs included, and every live camera delivered.

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


class Supervision:
    """See LoopHook."""

    def __init__(self, notifier: Notifier) -> None:
        self._notifier = notifier
        self._watch = ProgressWatch()
        self._runs = False

    def on_tick(self, snapshot: Snapshot) -> None:
        self._notifier.status(state_text(snapshot))
        if self._notifier.is_heartbeat_due and self._watch.has_progressed(snapshot):
            self._notifier.heartbeat()
        if not self._runs and snapshot.metrics.published:
            self._runs = True
            _log.info("the first body is sent: %s", state_text(snapshot))

    def let_go(self) -> None:
        self._notifier.stopping()


def state_text(snapshot: Snapshot) -> str:
    """Tracking state and camera states, without figures, so that it seldom changes."""
    if not snapshot.metrics.published:
        person = "waiting for the first frame"
    elif snapshot.metrics.tracking is Tracking.LOST:
        reason = snapshot.metrics.lost_reason
        person = "nobody is seen" if reason is None else reason.what
    else:
        person = "somebody is tracked"
    return "; ".join([person, *(_camera(status) for status in snapshot.cameras.values())])


def _camera(status: CaptureStatus) -> str:
    if status.state is CaptureState.LIVE:
        return f"{status.camera} {'silent' if status.is_silent else 'live'}"
    return f"{status.camera} {status.state.value}{f' ({status.reason})' if status.reason else ''}"
