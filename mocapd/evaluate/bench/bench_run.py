"""Benchmarks of one recording with each suitable tracker."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from mocapd.errors import ConfigError
from mocapd.evaluate.bench.bench_endurance import EnduranceFigures, endure
from mocapd.evaluate.bench.bench_input import BenchInput
from mocapd.evaluate.bench.bench_live import LiveFigures, Watching, bench_live
from mocapd.evaluate.bench.bench_step import StepFigures, bench_tracker
from mocapd.session.tracker_setup import Progress, ReadyTracker, cache_resources, ready_tracker
from mocapd.trackers.registry import TRACKERS
from mocapd.tracking.tracking_state import TrackingStateParams


@dataclass(frozen=True, slots=True, eq=False)
class BenchResults:
    """The measurements by tracker; `skipped`: the reason for each missing tracker."""

    recording: str
    steps: dict[str, StepFigures] = field(default_factory=dict)
    endurance: dict[str, EnduranceFigures] = field(default_factory=dict)
    live: dict[str, LiveFigures] = field(default_factory=dict)
    skipped: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class Bench:
    """`tracker`: its name; None: every tracker that the recording suits."""

    recording: BenchInput
    tracker: str | None
    cache_dir: Path
    tracking: TrackingStateParams
    progress: Progress

    def steps(self) -> BenchResults:
        """Time every step of the whole recording. Raises ConfigError for what a tracker lacks."""
        found = BenchResults(self.recording.name)
        for name, ready in self._trackers(found):
            progress = partial(self.progress, f"timing {name}")
            found.steps[name] = bench_tracker(ready, self.recording, progress)
        return found

    def endurance(self, minutes: float) -> BenchResults:
        """Run each tracker for so long [min]. Raises ConfigError for what a tracker lacks."""
        found = BenchResults(self.recording.name)
        for name, ready in self._trackers(found):
            progress = partial(self.progress, f"running {name}, seconds")
            found.endurance[name] = endure(ready, self.recording, minutes, progress)
        return found

    def live(
        self, command: Sequence[str], duration_s: float, watching: Watching | None = None
    ) -> BenchResults:
        """Run the daemon for `duration_s` [s] with each tracker; see `bench_live` for `command` and
        `watching`.

        Each tracker is built and stepped here first, to warm the daemon's caches.
        Raises ConfigError for what a tracker lacks, UnavailableError when the daemon does not run.
        """
        found = BenchResults(self.recording.name)
        rig = self.recording.calibration.rig
        for name, ready in self._trackers(found):
            for frame_set in next(self.recording.chunks()):
                ready.tracker.step(frame_set, ready.shape)
            self.progress(f"running the daemon with {name} for {duration_s:.0f} s", 0, 1)
            found.live[name] = bench_live(
                (*command, "--tracker", name),
                len(rig.cameras) if rig else 0,
                duration_s,
                watching,
            )
        return found

    def _trackers(self, found: BenchResults) -> Iterator[tuple[str, ReadyTracker]]:
        """One at a time: only one is in memory."""
        for name in (self.tracker,) if self.tracker else TRACKERS:
            resources = cache_resources(self.cache_dir, self.progress, self.tracking)
            try:
                ready = ready_tracker(name, self.recording.calibration, resources)
            except ConfigError as error:
                if self.tracker:
                    raise
                found.skipped[name] = str(error)
                continue
            yield name, ready
