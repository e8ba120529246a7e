"""Contradictions between the description of cameras and their pictures."""

from dataclasses import dataclass
from enum import StrEnum


class Mistake(StrEnum):
    DELAY = "delay"
    EXCHANGED = "exchanged"
    MIRRORED = "mirrored"
    TURNED = "turned"
    ZOOMED = "zoomed"
    INVERTED = "inverted"  # camera-to-world where world-to-camera is wanted
    AXES = "axes"
    UNIT = "unit"
    CONTRADICTION = "contradiction"  # unexplained by any hypothesis


@dataclass(frozen=True, slots=True)
class CaptureFinding:
    """cameras: names of the affected ones, in the rig's order; what: the observation; fix: the remedy. late_s: of a delay,
    by how much the one camera's times are too early; 0 otherwise."""

    mistake: Mistake
    cameras: tuple[str, ...]
    what: str
    fix: str
    late_s: float = 0.0

    def __str__(self) -> str:
        return f"{self.what} -- {self.fix}"

    @property
    def is_mended(self) -> bool:
        """Whether the data are corrected, so that nothing is wrong any more."""
        return self.late_s != 0.0
