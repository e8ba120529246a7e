"""Another machine's clock, against clocks that are made up: the error is small, and is told."""

import itertools
from dataclasses import dataclass

import numpy as np
import pytest

from mocapd.capture.remote.clock_fit import ClockLine, ClockSample, clock_sample, fit_clock
from mocapd.capture.remote.clock_track import ClockTrack

START_NS = 86_400_000_000_000
MS = 1_000_000


@dataclass(frozen=True)
class Clock:
    """Another machine's: offset [s] and drift [ppm] against ours."""

    offset_s: float = 3.0
    drift_ppm: float = 50.0

    def remote_ns(self, local_ns: int) -> int:
        gone = local_ns - START_NS
        return local_ns + round(self.offset_s * 1e9) + round(gone * self.drift_ppm * 1e-6)


def asked(
    clock: Clock,
    seconds: float,
    jitter_ms: float,
    seed: int,
    begin_s: float = 0.0,
    every_s: float = 0.25,
) -> list[ClockSample]:
    """Questions, each way 0.2 ms and up to `jitter_ms` more."""
    random = np.random.default_rng(seed)
    samples = []
    for t_s in np.arange(begin_s, begin_s + seconds, every_s):
        asked_ns = START_NS + round(t_s * 1e9)
        out_ms, back_ms = 0.2 + random.uniform(0.0, jitter_ms, 2)
        taken_ns = asked_ns + round(out_ms * MS)
        answered_ns = taken_ns + 50_000
        came_ns = answered_ns + round(back_ms * MS)
        samples.append(
            clock_sample(asked_ns, clock.remote_ns(taken_ns), clock.remote_ns(answered_ns), came_ns)
        )
    return samples


def fitted(samples: list[ClockSample]) -> ClockLine:
    rows = [(one.local_ns, one.offset_ns, one.round_trip_ns) for one in samples]
    return fit_clock(*np.array(sorted(rows), dtype=np.int64).T)


def learned(samples: list[ClockSample]) -> ClockLine:
    track = ClockTrack()
    for sample in samples:
        track.add(sample)
    assert track.line is not None
    return track.line


def error_ms(line: ClockLine, clock: Clock, at_ns: int) -> float:
    return (line.local_from_remote(clock.remote_ns(at_ns)) - at_ns) / MS


@pytest.mark.parametrize("seed", range(40))
def test_three_seconds_off_50_ppm_and_20_ms_of_jitter_cost_less_than_3_ms(seed: int) -> None:
    clock = Clock()
    samples = asked(clock, 60.0, 20.0, seed)
    line = fitted(samples)
    assert abs(error_ms(line, clock, samples[-1].local_ns)) < 3.0
    # also a second on, in which the link is silent
    assert abs(error_ms(line, clock, samples[-1].local_ns + 1_000 * MS)) < 3.0


@pytest.mark.parametrize("seed", range(8))
def test_asked_oftener_it_is_known_within_seconds(seed: int) -> None:
    clock = Clock()
    samples = asked(clock, 4.0, 20.0, seed, every_s=0.05)
    assert abs(error_ms(learned(samples), clock, samples[-1].local_ns)) < 3.0


def test_the_told_uncertainty_is_worth_its_name() -> None:
    clock = Clock(offset_s=-7.0, drift_ppm=-80.0)
    off = []
    for seed, seconds in itertools.product(range(60), (4.0, 20.0, 90.0)):
        samples = asked(clock, seconds, 20.0, seed)
        line = fitted(samples)
        sigmas = 1e6 * abs(error_ms(line, clock, line.reference_ns)) / line.uncertainty_ns
        off.append(sigmas)
    assert np.mean(np.array(off) < 2.0) > 0.85
    assert max(off) < 8.0


def test_a_quiet_wire_gives_tenths_of_a_millisecond_and_the_drift() -> None:
    clock = Clock(drift_ppm=50.0)
    samples = asked(clock, 110.0, 0.3, seed=1)
    line = fitted(samples)
    assert abs(error_ms(line, clock, line.reference_ns)) < 0.1
    assert line.drift == pytest.approx(50e-6, abs=3e-6)
    assert line.asymmetry_ns < 0.4 * MS


def test_a_few_absurd_answers_change_nothing() -> None:
    clock = Clock()
    samples = asked(clock, 30.0, 5.0, seed=2)
    line = learned(samples)
    for i in (20, 50, 51, 90):
        wrong = ClockSample(samples[i].local_ns, samples[i].offset_ns + 10**10, 10 * MS)
        samples[i] = wrong
    assert error_ms(learned(samples), clock, line.reference_ns) == pytest.approx(
        error_ms(line, clock, line.reference_ns), abs=0.5
    )


def test_a_machine_that_slept_has_another_clock_within_a_second() -> None:
    before, after = Clock(offset_s=3.0), Clock(offset_s=-600.0)
    samples = asked(before, 60.0, 5.0, seed=3)
    later = asked(after, 1.0, 5.0, seed=4, begin_s=60.0)
    line = learned(samples + later)
    assert abs(error_ms(line, after, later[-1].local_ns)) < 5.0


def test_there_and_back_is_the_same_time() -> None:
    line = ClockLine(START_NS, 3_000_000_000, 5e-5, 1.0, 1.0)
    for gone_ns in (0, 10**9, 10**14):
        at_ns = START_NS + gone_ns
        assert abs(line.local_from_remote(line.remote_from_local(at_ns)) - at_ns) <= 1


def trouble_of(samples: list[ClockSample]) -> str:
    track = ClockTrack()
    track.restart(samples[0].local_ns)  # as at the first answer
    for sample in samples:
        track.add(sample)
    return track.trouble(samples[-1].local_ns)


@pytest.mark.parametrize("drift_ppm", [-150_000, -1500, 1500, 20_000, 300_000])
def test_a_clock_that_runs_away_is_no_clock(drift_ppm: float) -> None:
    samples = asked(Clock(drift_ppm=drift_ppm), seconds=20, jitter_ms=2, seed=1)
    assert "uncertain" in trouble_of(samples)


@pytest.mark.parametrize("every_s", [0.25, 1.0])
def test_one_that_is_set_every_second_is_no_clock(every_s: float) -> None:
    samples = [
        sample
        for k in range(12)
        for sample in asked(
            Clock(offset_s=10.0 * (k % 5)), 4 * every_s, 2.0, k, 4 * k * every_s, every_s
        )
    ]
    assert "over and over" in trouble_of(samples)


def test_a_clock_of_quartz_that_a_time_service_corrects_or_that_slept_once_is_relied_on() -> None:
    for clock in (Clock(drift_ppm=100), Clock(drift_ppm=-500), Clock(drift_ppm=0)):
        assert trouble_of(asked(clock, seconds=60, jitter_ms=20, seed=3)) == ""
    before, after = Clock(offset_s=3.0), Clock(offset_s=-7.0)
    samples = asked(before, 30, 5, seed=1) + asked(after, 30, 5, seed=2, begin_s=40)
    assert trouble_of(samples) == ""
