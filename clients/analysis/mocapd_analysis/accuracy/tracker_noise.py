"""The error of a tracked wrist, as it was measured. Pure but for the random numbers given.

Of the shirt tracker's wrists on four recorded captures of two cameras at 30 Hz (pair_clutter_jacks, pair_lampoff_basket,
pair_office_traffic, pair_outdoor_async) against their ground truth: 4 to 15 mm an axis; correlated from frame to
frame by 0.56 to 0.82, three frames apart by 0.2 to 0.6; the part that is new in every frame 1.6 to 2.6 mm. One wrist
was worse, which was long behind the body: 50 mm, correlated by 0.93.
"""

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from mocapd.types import Floats


@dataclass(frozen=True, slots=True)
class Noise:
    """An axis's error: white_m, new in every frame, and slow_m, which fades within fades_s (Gauss-Markov)."""

    white_m: float
    slow_m: float
    fades_s: float


TRACKED = Noise(white_m=0.0025, slow_m=0.007, fades_s=0.205)


def draw(noise: Noise, frames: int, rate_hz: float, random: np.random.Generator) -> Floats:
    """Errors of a point (F,3) [m] at a constant rate."""
    kept = np.exp(-1.0 / (rate_hz * noise.fades_s))
    new = random.normal(size=(frames, 3)) * noise.slow_m
    new[1:] *= np.sqrt(1.0 - kept * kept)
    slow = lfilter([1.0], [1.0, -kept], new, axis=0)
    drawn: Floats = slow + random.normal(size=(frames, 3)) * noise.white_m
    return drawn
