"""Parameters of the canned tracker's motion."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class CannedMotion:
    """A loop of `loop_s` [s] in which the left hand waves `waves` times and the hips move `sway_m` [m] to each side."""

    loop_s: float = 4.0
    waves: int = 6
    sway_m: float = 0.06
