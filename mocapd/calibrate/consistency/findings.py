"""What does not agree between what is given of cameras and what their pictures show."""

from dataclasses import dataclass
from enum import StrEnum


class Mistake(StrEnum):
    """What was probably done wrong."""

    DELAY = "delay"
    EXCHANGED = "exchanged"
    MIRRORED = "mirrored"
    TURNED = "turned"
    ZOOMED = "zoomed"
    INVERTED = "inverted"  # camera-to-world where world-to-camera is wanted
    AXES = "axes"
    UNIT = "unit"
    CONTRADICTION = "contradiction"  # and no known mistake explains it


@dataclass(frozen=True, slots=True)
class CaptureFinding:
    """cameras: the names of those concerned, in the rig's order; what: the observation; fix: how to mend it. late_s: of a
    delay, by how much the one camera's times are too early; 0 otherwise."""

    mistake: Mistake
    cameras: tuple[str, ...]
    what: str
    fix: str
    late_s: float = 0.0

    def __str__(self) -> str:
        return f"{self.what} -- {self.fix}"

    @property
    def is_mended(self) -> bool:
        """Whether what was found can be used, so that nothing is wrong any more."""
        return self.late_s != 0.0
