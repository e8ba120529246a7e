"""The turn of a bone about its length that brings two of its joints to their triangulated direction."""

import numpy as np

from mocapd.fit.terms.joint_term import JointTerm
from mocapd.types import Floats


def triangulated_between_m(joints: JointTerm, first: int, second: int, most_sd_m: float) -> Floats:
    """Triangulated vector (3,) from one joint to another [m, world]; 0 if a joint has a larger standard deviation, as depth
    has from adjacent cameras."""
    places_m, sd_m = joints.crossings
    if max(sd_m[first], sd_m[second]) > most_sd_m:
        return np.zeros(3)
    between_m: Floats = places_m[second] - places_m[first]
    return between_m


def turn_about_rad(axis: Floats, now: Floats, wanted: Floats, shortest: float) -> float:
    """Angle about a unit axis (3,) from one vector (3,) to another [rad]; 0 if one is shorter than `shortest` across it."""
    a, b = now - (now @ axis) * axis, wanted - (wanted @ axis) * axis
    if min(np.linalg.norm(a), np.linalg.norm(b)) < shortest:
        return 0.0
    return float(np.arctan2(axis @ np.cross(a, b), a @ b))
