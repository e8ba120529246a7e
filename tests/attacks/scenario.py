"""What an attack is: something done to a real daemon, and a figure that must hold meanwhile."""

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Found:
    """What came of an attack: the figure as one line, and whether it is as wanted."""

    figure: str
    holds: bool


@dataclass(frozen=True)
class Scenario:
    """`wanted` is the figure that must hold, in words; `attack` does it, and may take minutes."""

    wanted: str
    attack: Callable[[], Found]
