"""The benchmark: what it prints, that stages add up, that time goes on in a long run."""

import json
from pathlib import Path

import numpy as np
import pytest

from mocapd.body.shape import BodyShape, mean_shape
from mocapd.calibration.calibration_record import Calibration, Wearer
from mocapd.evaluate.bench.bench_endurance import endure
from mocapd.evaluate.bench.bench_input import CHUNK, BenchInput
from mocapd.evaluate.bench.bench_step import REST, bench_tracker
from mocapd.session.tracker_setup import ReadyTracker
from mocapd.trackers.canned.tracker import CannedTracker
from mocapd.tracking.base import Track, Tracker
from mocapd.types import BodyState, Frame, FrameSet
from tests.cli.mocapd_process import mocapd, mocapd_here
from tests.cli.small_capture import FRAMES, write_capture

pytestmark = pytest.mark.kernels

PERIOD_NS = 33_333_333
SETS = CHUNK + 10


class StagedTracker(CannedTracker):
    """The canned tracker in two stages, the second in every other step."""

    def __init__(self) -> None:
        super().__init__()
        self.times_ns: list[int] = []
        self.resets = 0

    def reset(self, near: BodyState | None = None) -> None:
        self.resets += 1

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        self.times_ns.append(frames.t_ns)
        track = super().step(frames, shape)
        self.probe("look")
        if len(self.times_ns) % 2:
            self.probe("now and then")
        return track


def ready(tracker: Tracker) -> ReadyTracker:
    return ReadyTracker(tracker, mean_shape(1.75))


@pytest.fixture
def recording() -> BenchInput:
    """Two cameras, of which the second is 5 ms later."""
    pixels = np.zeros((4, 4, 3), np.uint8)

    def one(i: int) -> FrameSet:
        t_ns = i * PERIOD_NS
        frames = {"a": Frame("a", i, t_ns, pixels), "b": Frame("b", i, t_ns + 5_000_000, pixels)}
        return FrameSet(t_ns + 5_000_000, frames, 5_000_000)

    known = Calibration(wearer=Wearer(1.75))
    return BenchInput("test", known, SETS, lambda: map(one, range(SETS)))


def test_stages_add_up_to_the_step(recording: BenchInput) -> None:
    tracker = StagedTracker()
    told: list[tuple[int, int]] = []
    figures = bench_tracker(
        ready(tracker), recording, lambda done, total: told.append((done, total))
    )

    assert told[-1] == (2 * SETS, 2 * SETS)
    assert tracker.resets == 1  # between the run that warms up and the one that counts
    assert len(tracker.times_ns) == 2 * SETS
    assert figures.sets == SETS
    assert figures.tracked == 1.0
    assert list(figures.stages) == ["look", "now and then", REST]
    assert figures.stages["look"].share == 1.0
    assert figures.stages["now and then"].share == 0.5
    total_ms = sum(stage.mean_ms for stage in figures.stages.values())
    assert total_ms == pytest.approx(figures.mean_ms, rel=0.2)
    assert 0.0 < figures.median_ms <= figures.p95_ms


def test_a_tracker_without_stages_is_timed_as_a_whole(recording: BenchInput) -> None:
    figures = bench_tracker(ready(CannedTracker()), recording, lambda done, total: None)
    assert list(figures.stages) == [REST]


def test_in_a_long_run_time_goes_on(recording: BenchInput) -> None:
    for minutes in (0.002, 0.01, 0.05, 0.25, 2.0):  # a busy machine may not get round in the first
        tracker = StagedTracker()
        figures = endure(ready(tracker), recording, minutes, lambda done, total: None)
        if figures.sets > SETS:
            break
    assert figures.sets == len(tracker.times_ns) > SETS
    assert all(np.diff(tracker.times_ns) > 0)
    assert len(figures.median_ms) == len(figures.p95_ms) == len(figures.cpu_ms) == 4
    assert figures.minutes >= minutes


def test_a_run_of_one_chunk_has_the_memory_of_each_quarter_too(recording: BenchInput) -> None:
    figures = endure(ready(CannedTracker()), recording, 0.0, lambda done, total: None)
    assert figures.sets == CHUNK
    assert len(figures.rss_mb) == len(figures.median_ms) == 4


def test_it_prints_one_object(clean_env: dict[str, str], tmp_path: Path) -> None:
    capture = write_capture(tmp_path / "office")
    words = ("bench", "--tracker", "canned", "--capture", capture, "--json")
    outcome = mocapd(clean_env, *words)
    assert outcome.code == 0, outcome.err
    told = json.loads(outcome.out)
    assert list(told) == ["canned"]
    figures = told["canned"]
    assert figures["input"] == "office"
    assert figures["sets"] == FRAMES
    for key in ("median_ms", "p95_ms", "cpu_ms", "cpu_mean_ms", "rss_mb"):
        assert figures[key] > 0.0
    assert set(figures["stages"][REST]) == {"median_ms", "p95_ms", "mean_ms", "share"}


def test_it_prints_tables(clean_env: dict[str, str], tmp_path: Path) -> None:
    capture = write_capture(tmp_path / "office")
    outcome = mocapd_here(clean_env, "bench", "--tracker", "canned", "--capture", capture)
    assert outcome.code == 0, outcome.err
    assert "| canned  |   10 |" in outcome.out


def test_a_recording_cannot_be_a_webcam(clean_env: dict[str, str], tmp_path: Path) -> None:
    outcome = mocapd_here(clean_env, "bench", "--live", "--capture", tmp_path)
    assert outcome.code == 2
    assert "sim:SCENARIO" in outcome.err
