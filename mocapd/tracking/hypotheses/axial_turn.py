"""By how much a bone must turn about its length for two joints beside it to lie as they were seen."""

import numpy as np

from mocapd.fit.terms.joint_term import JointTerm
from mocapd.types import Floats


def seen_between_m(joints: JointTerm, first: int, second: int, most_sd_m: float) -> Floats:
    """From one joint to another (3,) [m, world], as the cameras' rays cross there; 0 where one of the places has a larger
    standard deviation: cameras side by side hardly know how deep it is."""
    (first_m, of_first), (second_m, of_second) = map(joints.triangulated, (first, second))
    if not (np.isfinite(of_first).all() and np.isfinite(of_second).all()):
        return np.zeros(3)
    variance = max(np.linalg.eigvalsh(of_first)[-1], np.linalg.eigvalsh(of_second)[-1])
    out: Floats = second_m - first_m if variance <= most_sd_m**2 else np.zeros(3)
    return out


def turn_about_rad(axis: Floats, now: Floats, wanted: Floats, shortest: float) -> float:
    """The angle about a unit axis (3,) from one vector (3,) to another; 0 where one is shorter than that across it."""
    a, b = now - (now @ axis) * axis, wanted - (wanted @ axis) * axis
    if min(np.linalg.norm(a), np.linalg.norm(b)) < shortest:
        return 0.0
    return float(np.arctan2(axis @ np.cross(a, b), a @ b))
