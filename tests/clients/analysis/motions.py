"""Known motions: a standing person whose joints go where a formula says."""

from collections.abc import Callable

import numpy as np

from mocapd.body.bones import NAMES
from mocapd.body.skeleton import PARENTS, standard_skeleton
from mocapd.types import Floats
from mocapd_analysis.session import Session

STATURE_M = 1.75
REST_M = standard_skeleton(STATURE_M).rest_m
AT = {name: number for number, name in enumerate(NAMES)}


def times(seconds: float, rate_hz: float = 60.0) -> Floats:
    """At a constant rate from 0."""
    return np.arange(round(seconds * rate_hz) + 1) / rate_hz


def standing(times_s: Floats) -> Floats:
    """The T-pose in every frame (F,J,3) [m]."""
    return np.tile(REST_M, (len(times_s), 1, 1))


def session(times_s: Floats, joints_m: Floats, confidence: Floats | None = None) -> Session:
    """Every joint seen, unless said otherwise."""
    if confidence is None:
        confidence = np.ones(joints_m.shape[:2])
    return Session("known", NAMES, PARENTS, times_s, joints_m, confidence)


def with_joint(times_s: Floats, name: str, way_m: Callable[[Floats], Floats]) -> Session:
    """Standing, but for one joint: `way_m` of the times gives (F,3), added to its place at rest."""
    joints_m = standing(times_s)
    joints_m[:, AT[name]] += way_m(times_s)
    return session(times_s, joints_m)


def turning_arm(times_s: Floats, side: str, angle_rad: Floats) -> Floats:
    """Standing, with one straight arm raised sideways by an angle (F,) from hanging (0) over held out (pi/2)."""
    joints_m = standing(times_s)
    sign = 1.0 if side == "left" else -1.0
    shoulder = REST_M[AT[f"{side}UpperArm"]]
    along = np.stack(
        [sign * np.sin(angle_rad), -np.cos(angle_rad), np.zeros_like(angle_rad)], axis=1
    )
    for name in ("LowerArm", "Hand"):
        length = np.linalg.norm(REST_M[AT[side + name]] - shoulder)
        joints_m[:, AT[side + name]] = shoulder + length * along
    return joints_m
