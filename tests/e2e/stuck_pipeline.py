"""A supervised daemon whose tracker stays in its twentieth step: run as a script. It tells the manager of that itself."""

import os
import sys
import threading

from mocapd.app.daemon.main_loop import Signals, run_daemon
from mocapd.app.daemon.notifier import Notifier
from mocapd.app.daemon.supervision import Supervision
from mocapd.body.shape import BodyShape, mean_shape
from mocapd.config.sections import Config
from mocapd.service.service import Service, Snapshot
from mocapd.session.camera_inputs import CameraInput
from mocapd.session.session import Session
from mocapd.trackers.canned.tracker import CannedTracker
from mocapd.tracking.base import Track
from mocapd.types import FrameSet
from tests.capture.films import SIZE_PX
from tests.e2e.fake_cameras import FakeCamera

GOOD_STEPS = 20


class _StuckTracker(CannedTracker):
    def __init__(self, notifier: Notifier) -> None:
        super().__init__()
        self._notifier, self._steps = notifier, 0

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        self._steps += 1
        if self._steps > GOOD_STEPS:
            self._notifier.status("stuck")
            threading.Event().wait()
        return super().step(frames, shape)


class _Beats:
    """Tells of each look that the main thread has taken."""

    def __init__(self, notifier: Notifier) -> None:
        self._notifier, self._count = notifier, 0

    def on_tick(self, snapshot: Snapshot) -> None:
        self._count += 1
        self._notifier.status(f"beat {self._count}")

    def let_go(self) -> None: ...


def main() -> int:
    """The daemon's exit code."""
    address = os.environ["NOTIFY_SOCKET"]
    notifier = Notifier.of_environment()
    beside = Notifier(address)
    tracker = _StuckTracker(beside)
    session = Session(
        (CameraInput(FakeCamera("a"), "test", SIZE_PX),), None, "", tracker, mean_shape(1.75)
    )
    signals = Signals()
    watched = (Supervision(notifier), _Beats(beside))
    return run_daemon(Service(Config(outputs={}), session), signals, hooks=watched)


if __name__ == "__main__":
    sys.exit(main())
