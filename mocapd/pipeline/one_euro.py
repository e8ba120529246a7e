"""The One-Euro filter on vectors and on rotations, batched over joints.

Casiez, Roussel, Vogel: 1 Euro Filter, CHI 2012. A first-order low-pass filter; its cutoff rises with the
speed of the signal: smooth at rest, prompt in fast motion. dt is in seconds and may vary.
"""

import math
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from mocapd.errors import ConfigError
from mocapd.geometry import rotations
from mocapd.types import Floats

Cutoff = TypeVar("Cutoff", float, Floats)


@dataclass(frozen=True, slots=True)
class OneEuroParams:
    """cutoff = min_cutoff_hz + beta * speed (eq. 5).

    min_cutoff_hz: cutoff at rest [Hz]; beta: what a unit of speed adds, [Hz/(m/s)] for positions,
    [Hz/(rad/s)] for rotations; speed_cutoff_hz: cutoff of the low-pass on the speed itself [Hz].
    """

    min_cutoff_hz: float
    beta: float
    speed_cutoff_hz: float = 2.0

    def __post_init__(self) -> None:
        for name in ("min_cutoff_hz", "speed_cutoff_hz"):
            if not getattr(self, name) > 0.0:
                raise ConfigError(f"{getattr(self, name)} Hz", f"smoothing.{name}", "above 0")
        if not (math.isfinite(self.beta) and self.beta >= 0.0):
            raise ConfigError(f"{self.beta}", "smoothing.beta", "give 0 or more")


def smoothing_factor(cutoff_hz: Cutoff, dt_s: float) -> Cutoff:
    """The weight of the newest sample, alpha = 1 / (1 + tau/dt), tau = 1/(2 pi cutoff) (eqs. 2, 3)."""
    r = (2.0 * math.pi * dt_s) * cutoff_hz
    return r / (1.0 + r)


class VectorOneEuro:
    """Filters vectors (...,3); each of the leading axes has a speed of its own."""

    def __init__(self, params: OneEuroParams) -> None:
        self._params = params
        self._value: Floats | None = None
        self._velocity: Floats = np.zeros(3)

    def reset(self) -> None:
        """The next sample passes unfiltered."""
        self._value = None

    def step(self, sample: Floats, dt_s: float) -> Floats:
        """The filtered value after a sample that came `dt_s` > 0 [s] after the one before."""
        if self._value is None:
            self._value, self._velocity = sample.copy(), np.zeros_like(sample)
            return sample.copy()
        p = self._params
        step = sample - self._value
        a = smoothing_factor(p.speed_cutoff_hz, dt_s)
        self._velocity = self._velocity + a * (step / dt_s - self._velocity)
        alpha = _adaptive_factor(p, self._velocity, dt_s)
        self._value = self._value + alpha * step
        return self._value.copy()


class RotationOneEuro:
    """Filters rotations (...,4) xyzw: the same filter in the tangent space at its last output."""

    def __init__(self, params: OneEuroParams) -> None:
        self._params = params
        self._value: Floats | None = None
        self._velocity: Floats = np.zeros(3)

    def reset(self) -> None:
        """The next sample passes unfiltered."""
        self._value = None

    def step(self, sample_xyzw: Floats, dt_s: float) -> Floats:
        """The filtered rotation after a sample that came `dt_s` > 0 [s] after the one before."""
        if self._value is None:
            self._value = rotations.canonical(sample_xyzw)
            self._velocity = np.zeros_like(self._value[..., :3])
            return self._value.copy()
        p = self._params
        # a rotation vector in the world's axes: from the last output to the sample, shortest way
        step = rotations.log(rotations.multiply(sample_xyzw, rotations.inverse(self._value)))
        a = smoothing_factor(p.speed_cutoff_hz, dt_s)
        self._velocity = self._velocity + a * (step / dt_s - self._velocity)
        turn = rotations.exp(_adaptive_factor(p, self._velocity, dt_s) * step)
        self._value = rotations.canonical(rotations.multiply(turn, self._value))
        return self._value.copy()


def _adaptive_factor(params: OneEuroParams, velocity: Floats, dt_s: float) -> Floats:
    speed = np.sqrt(np.vecdot(velocity, velocity))[..., None]
    return smoothing_factor(params.min_cutoff_hz + params.beta * speed, dt_s)
