"""Compares the typed stature with the scale of the extrinsics, and explains a difference; lengths to check with a tape
measure."""

from dataclasses import dataclass

import numpy as np

from mocapd.body.model import BodyModel, shape_of
from mocapd.body.shape import BodyShape, skeleton_of
from mocapd.body.skeleton import INDEX, global_from_local, joint_positions
from mocapd.calibrate.body_shape.body_shape_fit import ShapeFit
from mocapd.errors import Problem
from mocapd.fit.motion_state import MotionState
from mocapd.types import Pose

TOLERATED = 0.06  # people of one stature differ by some 2 %, so 6 % is an error
_ALIKE = 0.04  # two scales that differ by less agree
_NECK = INDEX["neck"]


@dataclass(frozen=True, slots=True)
class Scale:
    """The wearer in the pictures relative to the mean body of the typed stature; 1 when they agree.

    bones: from widths and lengths; height: of the neck over the floor, NaN for an unknown floor.
    """

    bones: float
    height: float


def scale_of(fit: ShapeFit, model: BodyModel, floor_known: bool) -> Scale:
    """One common factor of all proportions; the rest is variation between people."""
    information = fit.information + 1e-3 * np.eye(len(fit.factors))
    spread = np.diag(model.space.factor_sd**2) + np.linalg.inv(information)
    weight = np.linalg.inv(spread)
    bones = float(weight.sum(axis=0) @ fit.measured / weight.sum())
    height = float("nan")
    if floor_known:
        measured_m = [_neck_m(fit.states[k], model) for k in fit.counted]
        height = float(np.median(measured_m) / model.rest_m[_NECK, 1])
    return Scale(bones, height)


def scale_trouble(scale: Scale, stature_m: float, by_wearer: bool) -> Problem | None:
    """What disagrees, and its likely cause as something to do; None when all agree. by_wearer: the rig's scale came from
    the stature, not from a board."""
    off = abs(scale.bones - 1.0) > TOLERATED
    low = bool(np.isfinite(scale.height)) and abs(scale.height - 1.0) > TOLERATED
    if off and low and abs(scale.bones - scale.height) > 2.0 * _ALIKE:
        return Problem(
            f"arms and shoulders look {_percent(scale.bones)} than usual for {stature_m:.2f} m, the"
            f" height over the floor {_percent(scale.height)}",
            "",
            "measure again, standing upright; if it stays, do the room again with the floor",
        )
    if off:
        seems_m = scale.bones * stature_m
        board = (
            "the room was scaled by another stature: do it again with this one"
            if by_wearer
            else "check the ruler printed on the board with a real one: it may have been printed at"
            " another scale, then give the right size of a square and do lens and room again"
        )
        return Problem(
            f"in this room you look {seems_m:.2f} m tall, {_percent(scale.bones)} than the"
            f" {stature_m:.2f} m that you typed",
            "",
            f"correct the stature; if it is right, {board}",
        )
    if low:
        return Problem(
            f"your neck is {_percent(scale.height)} over the floor than usual for {stature_m:.2f} m",
            "",
            "the floor seems to lie wrong: stand on it without a step or a bent knee and measure"
            " again; if it stays, lay the board on the floor and do the room again",
        )
    return None


def _percent(ratio: float) -> str:
    share = round(100.0 * abs(ratio - 1.0))
    return f"{share} % {'more' if ratio > 1.0 else 'less'}"


def _neck_m(state: MotionState, model: BodyModel) -> float:
    skeleton = skeleton_of(shape_of(model, state.factors))
    pose = Pose(state.root_m, global_from_local(skeleton, state.local_xyzw))
    return float(joint_positions(skeleton, pose)[_NECK, 1])


def lengths_cm(shape: BodyShape) -> dict[str, float]:
    """By name, between the centres of joints [cm]."""
    skeleton = skeleton_of(shape)
    at = {name: skeleton.rest_m[i] for i, name in enumerate(skeleton.names)}

    def length_cm(a: str, b: str) -> float:
        return float(100.0 * sum((at[a] - at[b]) ** 2) ** 0.5)

    upper = length_cm("leftUpperArm", "leftLowerArm")
    fore = length_cm("leftLowerArm", "leftHand")
    return {
        "shoulder to shoulder": length_cm("leftUpperArm", "rightUpperArm"),
        "upper arm": upper,
        "forearm": fore,
        "arm to the wrist": upper + fore,
        "hips to neck": length_cm("hips", "neck"),
    }
