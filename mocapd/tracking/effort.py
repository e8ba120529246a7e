"""How much a tracker computes for a frame set, and what it leaves out first on a machine that is too slow.

The core has no clock: whoever steps a tracker measures, and hands an effort down. For a given effort the same frames give
the same bodies.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from types import MappingProxyType


class Effort(Enum):
    """From all of the work to what tracking cannot do without."""

    FULL = "full"
    SAVING = "saving"
    LEAST = "least"


@dataclass(frozen=True, slots=True)
class OptionalWork:
    """How much of its optional work a tracker does; the dearest comes first.

    other_poses: once in so many ticks (see `ticks.py`) a frame tries other poses of arms and legs that the pictures do not
    confirm, and a body that faces the other way; network, depths, looks: between two uses of the network of joints, of
    stereo depths, and between two frames that teach the look of the clothes or the light on the shirt, so many times the
    usual time passes; uncovered: the same between two searches for ghosts in the background; legs: below a trunk that the
    shirt carries, legs and head are fitted in one of so many frames, and go on as they moved in the others;
    fewer_iterations: of the solver; fine: at most so many of its iterations look at all pixels.
    """

    other_poses: int = 1
    network: int = 1
    depths: int = 1
    looks: int = 1
    uncovered: int = 1
    legs: int = 1
    fewer_iterations: int = 0
    fine: int = 2


WORK: Mapping[Effort, OptionalWork] = MappingProxyType(
    {
        Effort.FULL: OptionalWork(),
        Effort.SAVING: OptionalWork(
            other_poses=3, network=2, depths=2, looks=2, uncovered=2, fewer_iterations=1
        ),
        Effort.LEAST: OptionalWork(
            other_poses=6,
            network=3,
            depths=4,
            looks=4,
            uncovered=3,
            legs=2,
            fewer_iterations=1,
            fine=1,
        ),
    }
)
