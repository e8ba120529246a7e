"""What a fault row is: something done to a real process at random, and what must come of it."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
_SMALL_ROOM = ROOT / "tests" / "e2e" / "two_webcams.toml"


@dataclass(frozen=True, slots=True)
class Extent:
    """How much of it: the seed of everything that is random, and the share of the full run, 1.0 for all of it."""

    seed: int
    share: float = 1.0

    @property
    def room(self) -> str:
        """The simulated room of two webcams: a short run has a small one, which other tests have rendered."""
        return "living_room" if self.share >= 1.0 else str(_SMALL_ROOM)

    @property
    def rate_hz(self) -> float:
        """Of four webcams in sockets: in a short run half of the usual one."""
        return 30.0 if self.share >= 1.0 else 15.0

    def of(self, count: float, least: float = 1.0) -> float:
        """So much of a count or a time."""
        return max(least, count * self.share)


@dataclass(frozen=True, slots=True)
class Came:
    """What came of it: figures for the table, and everything that was not as it should be."""

    figures: str
    wrong: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class FaultRow:
    """`fault` and `wanted` are the table's words; `run` does it, which may take minutes."""

    fault: str
    wanted: str
    run: Callable[[Extent], Came]
