"""A daemon whose tracker never ends its twentieth step: run as a script, it must end with 70 and say why."""

import sys

from mocapd.app.daemon.main_loop import Signals, run_daemon
from mocapd.body.shape import BodyShape, mean_shape
from mocapd.config.sections import Config, TrackerSection
from mocapd.errors import MocapdError
from mocapd.service.service import Service
from mocapd.session.camera_inputs import CameraInput
from mocapd.session.session import Session
from mocapd.trackers.canned.tracker import CannedTracker
from mocapd.tracking.base import Track
from mocapd.types import FrameSet
from tests.e2e.fake_cameras import FakeCamera


class StuckTracker(CannedTracker):
    """Counts to twenty, then for ever."""

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        track = super().step(frames, shape)
        self._steps = getattr(self, "_steps", 0) + 1
        while self._steps >= 20:
            self._steps += 1
        return track


def main() -> int:
    """The daemon's exit code."""
    config = Config(outputs={}, tracker=TrackerSection(stuck_s=2.0))
    camera = CameraInput(FakeCamera("cam0"), "test")
    session = Session((camera,), None, "", StuckTracker(), mean_shape(1.75))
    try:
        return run_daemon(Service(config, session), Signals())
    except MocapdError as error:
        print(error, file=sys.stderr)
        return error.exit_code


if __name__ == "__main__":
    sys.exit(main())
