"""Areas of the surface, in which pixels are counted: quarters of the trunk, six parts of each arm, head, and legs."""

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray


class Area(IntEnum):
    """The surface itself carries those of trunk and arms (`Surface.area`); evidence of a whole body adds the last ones."""

    NONE = 0
    TORSO_FRONT_UPPER_LEFT = 1
    TORSO_FRONT_UPPER_RIGHT = 2
    TORSO_FRONT_LOWER_LEFT = 3
    TORSO_FRONT_LOWER_RIGHT = 4
    TORSO_BACK_UPPER_LEFT = 5
    TORSO_BACK_UPPER_RIGHT = 6
    TORSO_BACK_LOWER_LEFT = 7
    TORSO_BACK_LOWER_RIGHT = 8
    LEFT_SHOULDER = 9
    LEFT_UPPER_ARM_FRONT = 10
    LEFT_UPPER_ARM_BACK = 11
    LEFT_FOREARM_FRONT = 12
    LEFT_FOREARM_BACK = 13
    LEFT_WRIST = 14
    RIGHT_SHOULDER = 15
    RIGHT_UPPER_ARM_FRONT = 16
    RIGHT_UPPER_ARM_BACK = 17
    RIGHT_FOREARM_FRONT = 18
    RIGHT_FOREARM_BACK = 19
    RIGHT_WRIST = 20
    TORSO = 21  # as one, where its quarters look alike
    HEAD = 22
    LEFT_THIGH = 23
    LEFT_SHIN = 24  # and foot
    RIGHT_THIGH = 25
    RIGHT_SHIN = 26


N_AREAS = len(Area)
TORSO_QUARTERS = tuple(area for area in Area if area.name.startswith("TORSO_"))
ARM_AREAS = {
    "left": slice(Area.LEFT_SHOULDER, Area.LEFT_WRIST + 1),
    "right": slice(Area.RIGHT_SHOULDER, Area.RIGHT_WRIST + 1),
}
FOREARM_AREAS = {
    "left": slice(Area.LEFT_FOREARM_FRONT, Area.LEFT_WRIST + 1),
    "right": slice(Area.RIGHT_FOREARM_FRONT, Area.RIGHT_WRIST + 1),
}
SHOULDER_END = 0.45  # of the upper arm, from the shoulder
FOREARM_END = 0.55  # of the forearm, from the elbow: then the wrist


def on_arms(area: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """Whether each area (T,) is one of an arm's."""
    return (area >= Area.LEFT_SHOULDER) & (area <= Area.RIGHT_WRIST)
