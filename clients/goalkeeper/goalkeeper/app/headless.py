"""A session played without a window: the same poses and the same seed give the same score, tick for tick."""

from dataclasses import dataclass

from goalkeeper.app.fixed_steps import FixedSteps
from goalkeeper.core.difficulty import START_LEVEL
from goalkeeper.core.events import Conceded, Paused, Saved
from goalkeeper.core.limbs import LIMBS
from goalkeeper.core.match import Match, MatchRules, Phase
from goalkeeper.core.pitch import TICK_S
from goalkeeper.core.scoring import Score
from goalkeeper.core.shots import Shooter
from goalkeeper.streams.sighting import PoseStream

_CALIBRATE_S = 8.0  # a recording in which nobody makes a T is played all the same
_ON_AFTER_S = 1.0  # after the stream's end: the ball in the air


@dataclass(frozen=True, slots=True)
class ShotLine:
    """One shot as it is printed; limb: what stopped it, empty for a goal."""

    number: int
    kind: str
    limb: str
    speed_mps: float
    points: int


@dataclass(frozen=True, slots=True)
class Report:
    """What came of a session; pauses: how often the player was lost."""

    score: Score
    level: float
    shots: tuple[ShotLine, ...]
    pauses: int
    played_s: float


def play_headless(
    stream: PoseStream,
    shooter: Shooter,
    shots: int | None,
    round_s: float,
    level: float = START_LEVEL,
) -> Report:
    """One round, as fast as it goes, until its end or the stream's; level: of the first shots."""
    rules = MatchRules(
        round_s=round_s, replay=False, calibrate_s=_CALIBRATE_S, shots=shots, level=level
    )
    match = Match(rules, shooter)
    steps = FixedSteps(match, stream)
    lines: list[ShotLine] = []
    pauses = ticks = after = 0
    while match.phase is not Phase.OVER and after * TICK_S < _ON_AFTER_S:
        ticks += 1
        after += stream.state().ended
        for event in steps.tick():
            if isinstance(event, Saved | Conceded):
                lines.append(_line(event))
            pauses += isinstance(event, Paused) and not stream.state().ended
    return Report(match.score, match.difficulty.level, tuple(lines), pauses, ticks * TICK_S)


def _line(event: Saved | Conceded) -> ShotLine:
    limb = LIMBS[event.outcome.limb].name if event.outcome.saved else ""
    points = event.points if isinstance(event, Saved) else 0
    return ShotLine(event.shot.number, event.shot.kind, limb, event.outcome.speed_mps, points)
