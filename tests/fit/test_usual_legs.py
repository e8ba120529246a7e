"""How unusual a pose of a leg is."""

import numpy as np

from mocapd.fit.priors.pose_prior import unusual_leg, usual_leg
from mocapd.geometry import rotations
from mocapd.types import Floats


def bent(side: str, thigh_rad: Floats, shank_rad: Floats) -> float:
    pose = usual_leg(side)
    pose[0], pose[1] = rotations.exp(thigh_rad), rotations.exp(shank_rad)
    return float(unusual_leg(pose[None], side)[0])


def test_knees_that_bend_forwards_are_more_unusual_than_those_that_bend_back() -> None:
    none = np.zeros(3)
    back, forwards = (bent("left", none, np.array([way, 0.0, 0.0])) for way in (0.8, -0.8))
    assert back < forwards


def test_both_legs_count_alike() -> None:
    thigh = np.array([-0.9, 0.2, 0.3])
    mirrored = thigh * np.array([1.0, -1.0, -1.0])
    assert np.isclose(bent("left", thigh, np.zeros(3)), bent("right", mirrored, np.zeros(3)))
