"""Confidence and uncertainty of each joint from the spreads of the points."""

import numpy as np

from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.published.hecht2009.mass_spring.body_points import JOINT_POINTS, JOINTS_OF_POINTS
from mocapd.published.hecht2009.mass_spring.frusta import NAMES
from mocapd.types import Floats

_HALF_M = 0.12  # the uncertainty at which a confidence halves
_SPRINGS_M = 0.03  # additional uncertainty by the springs, between measured and other points


def _part_of_joints() -> np.ndarray:
    part = np.full(N_JOINTS, NAMES.index("upper_trunk"))
    part[[INDEX["hips"], INDEX["spine"]]] = NAMES.index("lower_trunk")
    part[[INDEX["neck"], INDEX["head"]]] = NAMES.index("head")
    for side in ("left", "right"):
        for bone, name in (
            ("UpperArm", "upper_arm"), ("LowerArm", "forearm"), ("Hand", "forearm"),
            ("UpperLeg", "thigh"), ("LowerLeg", "shank"), ("Foot", "shank"), ("Toes", "shank"),
        ):  # fmt: skip
            part[INDEX[side + bone]] = NAMES.index(f"{side}_{name}")
    return part


_PART = _part_of_joints()


def joint_uncertainty_m(spread_m: Floats, head_m: float) -> Floats:
    """(22,) one standard deviation [m] of each joint's place; spread_m (16,): of points that filters know, else inf;
    head_m: of the head's."""
    out = np.full(N_JOINTS, np.inf)
    out[JOINTS_OF_POINTS] = spread_m[JOINT_POINTS]
    out[[INDEX["leftToes"], INDEX["rightToes"]]] = out[[INDEX["leftFoot"], INDEX["rightFoot"]]]
    # the trunk hangs between the head and the limbs' roots
    roots = [INDEX[s + b] for s in ("left", "right") for b in ("UpperArm", "UpperLeg")]
    trunk = np.hypot(_SPRINGS_M, np.sqrt(np.mean(out[roots] ** 2)))
    known: Floats = np.where(np.isfinite(out), np.hypot(out, 0.5 * _SPRINGS_M), trunk)
    known[[INDEX["neck"], INDEX["head"]]] = np.hypot(_SPRINGS_M, head_m)
    return known


def joint_confidence(before: Floats, uncertainty_m: Floats) -> Floats:
    """(22,) in 0..1: how much of a joint's part (11,) stands before the background, less the less certain its place is."""
    out: Floats = before[_PART] / (1.0 + (uncertainty_m / _HALF_M) ** 2)
    return out
