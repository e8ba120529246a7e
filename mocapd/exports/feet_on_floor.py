"""Shifts a motion vertically so that the supporting foot is on the floor.

While a foot is in contact with the floor, its lowest joint gets the height that it has in the T-pose on the floor y = 0.
Between two contacts, as in a jump, the shift is interpolated, so a jump keeps its height. Only the height changes, by the
same amount for the whole body.
"""

from dataclasses import replace

import numpy as np

from mocapd.errors import UsageError
from mocapd.exports.sampled_motion import SampledMotion
from mocapd.exports.unseen_limbs import LEAST_CONFIDENCE
from mocapd.types import Floats

_FEET = (("leftFoot", "leftToes"), ("rightFoot", "rightToes"))
_CONTACT_MPS = 0.25  # a slower foot is in contact with the floor
_NEAR_M = 0.10  # of the usual height of a foot in contact: one that is lifted slowly is higher
_SMOOTHED_S = 0.25  # keeps the tracker's noise out of the body's motion


def feet_on_floor(motion: SampledMotion) -> SampledMotion:
    """The motion on the floor. Raises UsageError without a visible foot on the floor."""
    names = motion.skeleton.names
    feet = [foot for foot in _FEET if all(joint in names for joint in foot)]
    heights, contacts = [], []
    for foot in feet:
        joints = [names.index(joint) for joint in foot]
        at_m = motion.joints_m[:, joints]
        heights.append((at_m[..., 1] - motion.skeleton.rest_m[joints, 1]).min(axis=1))
        steps_m = np.gradient(at_m, axis=0) if len(at_m) > 1 else np.zeros_like(at_m)
        slow = np.linalg.norm(steps_m, axis=2).min(axis=1) * motion.rate_hz < _CONTACT_MPS
        visible = (motion.confidence[:, joints] >= LEAST_CONFIDENCE).any(axis=1)
        contacts.append(slow & visible & (motion.gap == 0))
    contact = np.array(contacts, dtype=bool).reshape(len(feet), -1)
    if not contact.any():
        raise UsageError(
            "no foot is seen standing", "--feet floor", "leave it out: nothing shows the floor"
        )
    above_m = np.where(contact, np.array(heights), np.inf).min(axis=0)
    is_level = np.abs(above_m - np.median(above_m[np.isfinite(above_m)])) < _NEAR_M
    at = np.flatnonzero(is_level)
    lift_m = -np.interp(np.arange(len(above_m)), at, _smooth(above_m[at], motion.rate_hz))
    joints_m = motion.joints_m.copy()
    joints_m[..., 1] += lift_m[:, None]
    return replace(motion, joints_m=joints_m)


def _smooth(values: Floats, rate_hz: float) -> Floats:
    """The mean over _SMOOTHED_S around each value; fewer at both ends."""
    half = round(0.5 * _SMOOTHED_S * rate_hz)
    sums = np.concatenate([[0.0], np.cumsum(values)])
    at = np.arange(len(values))
    low, high = np.maximum(at - half, 0), np.minimum(at + half + 1, len(values))
    means: Floats = (sums[high] - sums[low]) / (high - low)
    return means
