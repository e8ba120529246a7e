"""A daemon whose camera has a bug: run as a script, it must not live on without that camera."""

import sys

from mocapd.app.daemon.main_loop import Signals, run_daemon
from mocapd.body.shape import mean_shape
from mocapd.config.sections import Config
from mocapd.service.service import Service
from mocapd.session.camera_inputs import CameraInput
from mocapd.session.session import Session
from mocapd.trackers.canned.tracker import CannedTracker
from mocapd.types import Frame


class DyingCamera:
    """Opens, and fails in a way that no source may."""

    name = "cam0"
    recorded = False

    def open(self) -> None: ...

    def read(self) -> Frame:
        return Frame(self.name, 1 // 0, 0, None)  # type: ignore[arg-type]  # never gets there

    def close(self) -> None: ...


def main() -> int:
    """The daemon's exit code."""
    config = Config(outputs={})
    session = Session(
        (CameraInput(DyingCamera(), "test"),), None, "", CannedTracker(), mean_shape(1.75)
    )
    return run_daemon(Service(config, session), Signals())


if __name__ == "__main__":
    sys.exit(main())
