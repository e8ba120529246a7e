"""Options of an export, and the motion prepared for a format."""

from dataclasses import dataclass, replace

import numpy as np

from mocapd.errors import UsageError
from mocapd.exports.formats import FORMATS
from mocapd.exports.sampled_motion import SampledMotion
from mocapd.exports.unseen_limbs import (
    LEAST_CONFIDENCE,
    LIMBS,
    unseen_legs,
    visibility_text,
    without_joints,
)
from mocapd.geometry import rotations
from mocapd.types import Floats

_TURN = rotations.exp(np.array([np.pi / 2, 0.0, 0.0]))  # +Y becomes +Z, +Z becomes -Y


_FEET = (("leftFoot", "leftToes"), ("rightFoot", "rightToes"))
_CONTACT_MPS = 0.25  # a slower foot is in contact with the floor
_NEAR_M = 0.10  # of the usual height of a foot in contact: one that is lifted slowly is higher
_SMOOTHED_S = 0.25  # keeps the tracker's noise out of the body's motion


def feet_on_floor(motion: SampledMotion) -> SampledMotion:
    """The motion shifted vertically so that the supporting foot is on the floor.

    While a foot is in contact with the floor, its lowest joint gets the height that it has in the T-pose on the floor y = 0.
    Between two contacts, as in a jump, the shift is interpolated, so a jump keeps its height. Only the height changes, by the
    same amount for the whole body. Raises UsageError without a visible foot on the floor.
    """
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
    # one of them, where half are higher: between two heights there may be none
    usual_m = np.quantile(above_m[np.isfinite(above_m)], 0.5, method="lower")
    is_level = np.abs(above_m - usual_m) < _NEAR_M
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


def z_up(motion: SampledMotion) -> SampledMotion:
    """The same motion with +Z up, its T-pose included, for programs that do not convert a file's axes; a person at rest then
    faces -Y."""
    back = rotations.inverse(_TURN)
    turned = rotations.multiply(rotations.multiply(_TURN, motion.global_xyzw), back)
    return replace(
        motion,
        skeleton=replace(motion.skeleton, rest_m=rotations.rotate(_TURN, motion.skeleton.rest_m)),
        joints_m=rotations.rotate(_TURN, motion.joints_m),
        global_xyzw=turned,
        up="z",
    )


@dataclass(frozen=True, slots=True)
class ExportOptions:
    """is_z_up: +Z up in place of +Y; has_all_legs: also exports legs that no camera saw; are_feet_on_floor: see
    feet_on_floor."""

    is_z_up: bool = False
    has_all_legs: bool = False
    are_feet_on_floor: bool = False


def check_options(name: str, options: ExportOptions) -> None:
    """Raises UsageError for an option that the format does not have."""
    if options.is_z_up and not FORMATS[name].takes_z_up:
        raise UsageError(
            f"a file of {name} is +Y up by its format",
            "--up z",
            "leave it out: programs that have +Z up turn the file when they read it",
        )


def prepared_motion(
    motion: SampledMotion, name: str, options: ExportOptions
) -> tuple[SampledMotion, str]:
    """The motion for this format, and a remark for the user, perhaps empty. Raises UsageError."""
    check_options(name, options)
    remark = visibility_text(motion)
    unseen = () if options.has_all_legs else unseen_legs(motion)
    left_out = frozenset(bone for leg in unseen for bone in LIMBS[leg])
    if options.are_feet_on_floor:
        motion = feet_on_floor(motion)
    if left_out and FORMATS[name].keeps_all_joints:
        motion = replace(motion, unmoved=left_out)
        remark += f"; the {' and '.join(unseen)} do not move (--legs all moves them)"
    elif left_out:
        motion = without_joints(motion, left_out)
        remark += f"; left out: the {' and '.join(unseen)} (--legs all has them)"
    return (z_up(motion) if options.is_z_up else motion), remark
