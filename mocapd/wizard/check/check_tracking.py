"""The tracker of the step Check: as the daemon will have it, on the setup's own pictures."""

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
from mocapd.tracking.known import known_shape
from mocapd.types import Rig
from mocapd.wizard.check.check_settings import CheckSettings
from mocapd.wizard.check.tracking_measures import TrackingMeasures
from mocapd.wizard.newest_body import NewestBody
from mocapd.wizard.only_cameras import OnlyCameras
from mocapd.wizard.step import Tell

_BUILDING = 0.8  # share of the preparation that is not the rehearsal


@dataclass(frozen=True, slots=True, eq=False)
class CheckTracker:
    """A tracker that is warm, its cameras, and where it leaves what it measures."""

    tracker: Tracker
    shape: BodyShape
    rig: Rig
    measures: TrackingMeasures


LoadTracker = Callable[[Calibration, CheckSettings, Path, Tell], CheckTracker]


def prepare(
    known: Calibration, settings: CheckSettings, cache_dir: Path, tell: Tell
) -> CheckTracker:
    """Build it and warm its kernels; takes seconds. Raises ConfigError or CannotCreateError."""
    section = settings.tracker
    known = known.assuming(section.stature_m)
    rig = known.rig
    assert rig is not None

    def progress(what: str, done: int, total: int) -> None:
        tell(what, _BUILDING * done / max(total, 1))

    progress("loading the pose database", 0, 1)
    measures = TrackingMeasures()
    name = measuring_tracker(section.name, known.wearer.has_shirt)
    shape = known_shape(known)
    ready = ready_tracker(
        name,
        known,
        cache_resources(cache_dir, progress, section.tracking),
        rehearsal=lambda done, total: tell(
            "preparing the tracker", _BUILDING + (1.0 - _BUILDING) * done / total
        ),
        watched=lambda one: MeasuringTracker(
            one, rig, shape, measures.add, by_outline=not entry(name).reads_shirt
        ),
    )
    measures.taken()
    return CheckTracker(ready.tracker, ready.shape, rig, measures)


class CheckTracking:
    """Runs from its making to `stop`; used by the wizard's thread."""

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
        self._entry = OnlyCameras(self._collector, frozenset(prepared.rig.names))
        self._loop.start()
        shown.loop = self._loop
        hub.join(self._entry)

    def measures(self) -> tuple[Measure, ...]:
        """What was measured since the last time."""
        return self._prepared.measures.taken()

    def metrics(self) -> Metrics:
        """How it does."""
        return self._loop.metrics()

    def counts(self) -> Mapping[str, CameraCounts]:
        """What became of each camera's frames since the start."""
        return self._collector.counts().cameras

    def stop(self) -> None:
        """End; nothing is shown any more."""
        self._hub.leave(self._entry)
        self._loop.stop()
        self._shown.forget()
