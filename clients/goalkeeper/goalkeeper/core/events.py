"""What happens in a match, one record each: for sounds, messages and tests."""

from dataclasses import dataclass

from goalkeeper.core.ball import Outcome
from goalkeeper.core.reach import Reach
from goalkeeper.core.shots import Shot


@dataclass(frozen=True, slots=True)
class ReachFound:
    """The T-pose was held long enough."""

    reach: Reach


@dataclass(frozen=True, slots=True)
class Counted:
    """The countdown shows another number; 0: go."""

    number: int


@dataclass(frozen=True, slots=True)
class Kicked:
    """A ball is shot."""

    shot: Shot


@dataclass(frozen=True, slots=True)
class Saved:
    """The shot was stopped, for so many points."""

    shot: Shot
    outcome: Outcome
    points: int
    streak: int


@dataclass(frozen=True, slots=True)
class Conceded:
    """The shot went in."""

    shot: Shot
    outcome: Outcome


@dataclass(frozen=True, slots=True)
class Paused:
    """The clock stands; what was in the air does not count."""

    reason: str


@dataclass(frozen=True, slots=True)
class RoundOver:
    """The time is up."""


Event = ReachFound | Counted | Kicked | Saved | Conceded | Paused | RoundOver
