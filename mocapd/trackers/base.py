"""The interface of every tracker."""

from typing import Protocol

from mocapd.calibration.record import Calibration
from mocapd.errors import ConfigError
from mocapd.types import FrameSet, Skeleton, Track


class Tracker(Protocol):
    """A pure step machine: no threads, no clock, no I/O.

    Promises, each tested on every registered tracker: time comes only from `frames.t_ns` and the
    frames' own `t_ns`; the same frames after `reset()` give the same output; a missing camera or
    an empty room gives `lost`, never an exception; frames are not written to.
    """

    name: str

    @property
    def skeleton(self) -> Skeleton:
        """The skeleton of the person being tracked; its proportions may be refined while tracking."""
        ...

    def reset(self) -> None:
        """Forget everything learned since construction."""
        ...

    def step(self, frames: FrameSet) -> Track:
        """Track one frame set; times never decrease from call to call."""
        ...


def stature_m(calibration: Calibration) -> float:
    """The wearer's height [m]. Raises ConfigError where it is not known."""
    if calibration.wearer.stature_m is None:
        raise ConfigError(
            "the wearer's height is not known", "tracker.stature_m", "give it in metres"
        )
    return calibration.wearer.stature_m
