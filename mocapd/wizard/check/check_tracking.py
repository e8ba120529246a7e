"""The tracker of the step Check: the daemon's future tracker, on the setup's own pictures."""

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from mocapd.body.shape import BodyShape, skeleton_of
from mocapd.calibrate.verification.check_measure import Measure, MeasuringTracker
from mocapd.calibration.calibration_record import Calibration
from mocapd.pipeline.bundler import CameraCounts
from mocapd.pipeline.collector import FrameCollector
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.pipeline.loop import OnDeath, PipelineLoop
from mocapd.pipeline.metrics import Metrics
from mocapd.pipeline.smoothing import Smoother
from mocapd.session.tracker_setup import cache_resources, ready_tracker
from mocapd.trackers.registry import entry, measuring_tracker
from mocapd.tracking.base import Tracker
from mocapd.tracking.tracker_inputs import wearer_shape
from mocapd.types import Rig
from mocapd.wizard.check.check_settings import CheckSettings
from mocapd.wizard.newest_body import NewestBody
from mocapd.wizard.step import Tell

_BUILDING = 0.8  # share of the preparation before the rehearsal


@dataclass(frozen=True, slots=True, eq=False)
class CheckTracker:
    """A warm tracker, its cameras, and the queue of its measures, from the pipeline's thread to the wizard's."""

    tracker: Tracker
    shape: BodyShape
    rig: Rig
    measures: deque[Measure]


LoadTracker = Callable[[Calibration, CheckSettings, Path, Tell], CheckTracker]


def prepare(
    calibration: Calibration, settings: CheckSettings, cache_dir: Path, report: Tell
) -> CheckTracker:
    """Build it and warm its kernels; takes seconds. Raises ConfigError or CannotCreateError."""
    section = settings.tracker
    calibration = calibration.assuming(section.stature_m)
    rig = calibration.rig
    assert rig is not None

    def progress(what: str, done: int, total: int) -> None:
        report(what, _BUILDING * done / max(total, 1))

    progress("loading the pose database", 0, 1)
    measures: deque[Measure] = deque()
    name = measuring_tracker(section.name, calibration.wearer.has_shirt)
    shape = wearer_shape(calibration)
    ready = ready_tracker(
        name,
        calibration,
        cache_resources(cache_dir, progress, section.tracking),
        rehearsal=lambda done, total: report(
            "preparing the tracker", _BUILDING + (1.0 - _BUILDING) * done / total
        ),
        watched=lambda one: MeasuringTracker(
            one, rig, shape, measures.append, by_outline=not entry(name).reads_shirt
        ),
    )
    measures.clear()
    return CheckTracker(ready.tracker, ready.shape, rig, measures)


class CheckTracking:
    """Runs from its creation to `stop`; used by the wizard's thread."""

    def __init__(
        self,
        hub: FrameHub,
        prepared: CheckTracker,
        smoothing: str,
        shown: NewestBody,
        died: OnDeath,
    ) -> None:
        self.rig = prepared.rig
        self._hub, self._prepared, self._shown = hub, prepared, shown
        self._collector = FrameCollector(prepared.rig.names, hub.bundler)
        smoother = Smoother(smoothing, skeleton_of(prepared.shape))
        self._loop = PipelineLoop(
            self._collector, prepared.tracker, prepared.shape, smoother, shown.bodies, died
        )
        self._loop.start()
        shown.loop = self._loop
        hub.join(self._collector)

    def measures(self) -> tuple[Measure, ...]:
        """New measures since the last call."""
        measures = self._prepared.measures
        return tuple(measures.popleft() for _ in range(len(measures)))

    def metrics(self) -> Metrics:
        return self._loop.metrics()

    def counts(self) -> Mapping[str, CameraCounts]:
        """Counts of each camera's frames since the start."""
        return self._collector.counts().cameras

    def stop(self) -> None:
        """Stop the pipeline and clear the shown body."""
        self._hub.leave(self._collector)
        self._loop.stop()
        self._shown.forget()
