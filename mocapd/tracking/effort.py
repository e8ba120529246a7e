"""How much optional work a tracker does for a frame set, and which work it skips first.

The core has no clock: the caller measures time and sets an effort. At a given effort the same frames give the same
bodies.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from types import MappingProxyType


class Effort(Enum):
    """From all work to the essential work alone."""

    FULL = "full"
    SAVING = "saving"
    LEAST = "least"


@dataclass(frozen=True, slots=True)
class OptionalWork:
    """Amounts of optional work; the most expensive comes first.

    hypotheses: ticks (see `ticks.py`) between tests of other arm and leg poses;
    network, depths, learning, ghosts: factors on the usual interval between uses of the keypoint network, stereo depth
    measurements, updates of the clothes' and the shirt's colours, and searches for ghosts in the background; legs: with a
    trunk from the shirt, legs and head are fitted in one of this many frame sets, or one more while they hardly move, and
    predicted in the others;
    fewer_iterations: solver iterations to skip; fine: most iterations at full pixel density.
    """

    hypotheses: int = 1
    network: int = 1
    depths: int = 1
    learning: int = 1
    ghosts: int = 1
    legs: int = 1
    fewer_iterations: int = 0
    fine: int = 2


WORK: Mapping[Effort, OptionalWork] = MappingProxyType(
    {
        Effort.FULL: OptionalWork(),
        Effort.SAVING: OptionalWork(
            hypotheses=3, network=2, depths=2, learning=2, ghosts=2, fewer_iterations=1
        ),
        Effort.LEAST: OptionalWork(
            hypotheses=6,
            network=3,
            depths=4,
            learning=4,
            ghosts=3,
            legs=2,
            fewer_iterations=1,
            fine=1,
        ),
    }
)
