"""What is written over the picture, as words alone."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class HudText:
    """Everything that is written; an empty string is not shown. level: 0..1."""

    score: str = ""
    clock: str = ""
    streak: str = ""
    foot: str = ""
    keys: str = ""
    big: str = ""
    message: str = ""
    popup: str = ""
    level: float = 0.0
    table: str = ""
