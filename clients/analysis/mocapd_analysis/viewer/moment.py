"""What the viewer is to show now; who makes it needs no viewer."""

from dataclasses import dataclass

from mocapd_analysis.measures import Measures


@dataclass(frozen=True, slots=True)
class Moment:
    """The sessions, the same ones as long as nothing is new, and what is said of them (live: whether frames come)."""

    sessions: tuple[Measures, ...]
    status: str = ""
    is_live: bool = False
