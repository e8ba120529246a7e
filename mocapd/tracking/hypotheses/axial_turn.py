"""By how much a bone must turn about its length for two joints beside it to lie as they were seen."""

import numpy as np

from mocapd.fit.terms.joint_term import JointTerm
from mocapd.types import Floats


def seen_between_m(joints: JointTerm, first: int, second: int, most_sd_m: float) -> Floats:
    """From one joint to another (3,) [m, world], as the cameras' rays cross there; 0 where one of the places has a larger
    standard deviation: cameras side by side hardly know how deep it is."""
    places_m, sd_m = joints.crossings
    if max(sd_m[first], sd_m[second]) > most_sd_m:
        return np.zeros(3)
    between_m: Floats = places_m[second] - places_m[first]
    return between_m


def turn_about_rad(axis: Floats, now: Floats, wanted: Floats, shortest: float) -> float:
    """The angle about a unit axis (3,) from one vector (3,) to another; 0 where one is shorter than that across it."""
    a, b = now - (now @ axis) * axis, wanted - (wanted @ axis) * axis
    if min(np.linalg.norm(a), np.linalg.norm(b)) < shortest:
        return 0.0
    return float(np.arctan2(axis @ np.cross(a, b), a @ b))
