"""A ball is saved exactly when ball and keeper touch: 200 shots in a match, looked at again by the slow twin."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from goalkeeper.app.fixed_steps import FixedSteps
from goalkeeper.core.ball import ShotBall
from goalkeeper.core.limbs import LimbPose
from goalkeeper.core.match import Match, MatchRules, Phase
from goalkeeper.core.pitch import TICK_HZ, TICK_S
from goalkeeper.core.shots import RandomShooter
from goalkeeper.streams.demo_script import demo_scenario
from goalkeeper.streams.person_stream import PersonStream
from goalkeeper.streams.recorded_stream import RecordedStream
from goalkeeper.streams.sighting import PoseStream, Sighting, StreamState
from tests.clients.goalkeeper.naive_touch import GRAZING_M, KeptTick, least_gap_m
from tests.clients.goalkeeper.session import SESSION_S, record_session

pytestmark = pytest.mark.long

SHOTS = 200
SEEDS = (1, 2, 3, 4, 5, 6, 7, 8)  # of the recording, which is played again for each


class Heard:
    """What a stream gives in each tick, kept, so that it is decoded once and played as often as is needed."""

    def __init__(self, stream: PoseStream, seconds: float) -> None:
        ticks = range(1, int(seconds * TICK_HZ))
        self._polls = [stream.poll(tick * TICK_S) for tick in ticks]
        self._next = 0

    def again(self) -> "Heard":
        """From the start."""
        self._next = 0
        return self

    def poll(self, now_s: float) -> list[Sighting]:
        """Of the next tick."""
        assert now_s == pytest.approx((self._next + 1) * TICK_S)
        self._next += 1
        return self._polls[self._next - 1]

    def state(self) -> StreamState:
        """Whether there is a next tick."""
        return StreamState(ended=self._next == len(self._polls))

    def close(self) -> None:
        """Nothing to let go of."""


def _shots(stream: PoseStream, shots: int, seed: int) -> Iterator[tuple[ShotBall, list[KeptTick]]]:
    """Each shot of a match with the ticks of its flight, once it has ended."""
    rules = MatchRules(shots=shots, replay=False, calibrate_s=4.0, level=0.8)
    match = Match(rules, RandomShooter(seed))
    steps = FixedSteps(match, stream)
    ticks: list[KeptTick] = []
    before: LimbPose | None = None
    while match.phase is not Phase.OVER:
        assert not stream.state().ended, "the session is too short"
        ball, begun = match.ball, match.ball is not None and match.ball.outcome is None
        steps.tick()
        moment = match.moment()
        if ball is not None and begun and before is not None and moment is not None:
            ticks.append(KeptTick(ball.since_launch_s - TICK_S, before, moment.pose))
            if ball.outcome is not None:
                yield ball, ticks
                ticks = []
        before = None if moment is None else moment.pose


def _saves(stream: PoseStream, shots: int, seed: int) -> int:
    """How many were saved; none is counted otherwise than the slow twin says."""
    outcomes = []
    for ball, ticks in _shots(stream, shots, seed):
        assert ball.outcome is not None
        gap_m = least_gap_m(ball.shot.flight, ticks)
        if abs(gap_m) > GRAZING_M:
            assert ball.outcome.saved == (gap_m < 0.0), (ball.shot, ball.outcome, gap_m)
        outcomes.append(ball.outcome.saved)
    assert len(outcomes) == shots
    return sum(outcomes)


def test_against_the_demos_person() -> None:
    stream = PersonStream(demo_scenario(), rate_hz=30.0, latency_s=0.05)
    assert 20 < _saves(stream, SHOTS, seed=11) < SHOTS - 20


def test_against_a_recording(tmp_path: Path) -> None:
    path = record_session(tmp_path / "session.mcap", seconds=SESSION_S)
    session = Heard(RecordedStream(path), SESSION_S)
    each = SHOTS // len(SEEDS)
    saves = sum(_saves(session.again(), each, seed) for seed in SEEDS)
    assert 20 < saves < SHOTS - 20
