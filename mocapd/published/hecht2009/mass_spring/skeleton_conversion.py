"""Converts between the sixteen points and the skeleton.

Points determine trunk, hips and the directions of limbs. They determine the twist of an upper arm or thigh as far as its
joint is bent, but not the twist of forearm, shank and head, nor the rotations of hands and feet. An undetermined rotation
is the smallest one from the bone above.
"""

import numpy as np

from mocapd.body.skeleton import INDEX, N_JOINTS, joint_positions
from mocapd.geometry import rotations
from mocapd.published.hecht2009.mass_spring.body_points import (
    ANKLE,
    ELBOW,
    HEAD,
    HIP,
    JOINT_POINTS,
    JOINTS_OF_POINTS,
    KNEE,
    N_POINTS,
    NECK,
    SHOULDER,
    WAIST,
    WRIST,
)
from mocapd.published.hecht2009.mass_spring.mass_spring_body import MassSpringBody
from mocapd.types import Floats, Pose

# the limbs: left arm, right arm, left leg, right leg
_UPPER = np.array([*SHOULDER, *HIP])
_MIDDLE = np.array([*ELBOW, *KNEE])
_END = np.array([*WRIST, *ANKLE])
_UPPER_BONE, _LOWER_BONE, _END_BONE = (
    np.array([INDEX[side + bone] for bone in bones for side in ("left", "right")])
    for bones in (("UpperArm", "UpperLeg"), ("LowerArm", "LowerLeg"), ("Hand", "Foot"))
)
_COLLAR = np.array([INDEX[side + "Shoulder"] for side in ("left", "right")])
_TOES = np.array([INDEX[side + "Toes"] for side in ("left", "right")])
# elbows bend forwards, knees backwards
_BENDS_TO = np.array([[0.0, 0.0, 1.0]] * 2 + [[0.0, 0.0, -1.0]] * 2)
_TRUNK = np.array([INDEX[name] for name in ("spine", "chest", "upperChest", "neck")])
_TRUNK_SHARES = np.array([1 / 3, 2 / 3, 1.0, 0.5])
# lines of the upper and the lower trunk, each with the waist
_TRUNK_POINTS = np.array([[*SHOULDER, *WAIST], [*HIP, *WAIST]])
_NEXT, _LAST = np.array([1, 2, 0]), np.array([2, 0, 1])

# Standard deviations [rad] of a twist that nothing determines: half of the joints' ranges
_OPEN_TWIST_RAD = np.radians([60.0, 60.0, 30.0, 30.0])
_POINT_SD_M = 0.03  # of a limb's point across the limb
_HINGE_SD_RAD = np.radians(15.0)  # the hinge's own direction differs between people and skeletons


def skeleton_from_points(body: MassSpringBody, points_m: Floats) -> Pose:
    """The pose of the body's skeleton for points (16,3) [m, world]. Bones have fixed lengths, so joints differ from points
    by the springs' extension; the trunk is the best fit to shoulders and hips."""
    p, rest = np.asarray(points_m, dtype=float), body.skeleton.rest_m
    quats = np.empty((N_JOINTS, 4))
    upper, lower = _trunk_turns(p, body.rest_m)
    # head, collar bones, upper parts of the limbs
    bone = rest[_LOWER_BONE] - rest[_UPPER_BONE]
    middle_m = 0.5 * (p[SHOULDER[0]] + p[SHOULDER[1]])
    from_middle = rest[_COLLAR] - 0.5 * (rest[_UPPER_BONE[0]] + rest[_UPPER_BONE[1]])
    turned = _swung(
        np.stack([upper] * 5 + [lower] * 2),
        np.concatenate([
            body.rest_m[[HEAD]] - body.rest_m[NECK], rest[_UPPER_BONE[:2]] - rest[_COLLAR], bone
        ]),
        np.concatenate([
            p[[HEAD]] - p[NECK],
            p[list(SHOULDER)] - middle_m - rotations.rotate(upper, from_middle),
            p[_MIDDLE] - p[_UPPER],
        ]),
    )  # fmt: skip
    head, untwisted = turned[0], turned[3:]
    quats[_COLLAR] = turned[1:3]
    # the spine's three bones and the two of the neck share their bends evenly
    quats[_TRUNK] = rotations.slerp(
        np.stack([lower, lower, lower, upper]), np.stack([upper, upper, upper, head]), _TRUNK_SHARES
    )
    quats[INDEX["hips"]], quats[INDEX["head"]] = lower, head
    reach = p[_END] - p[_MIDDLE]
    twist, sine = _bend_side(untwisted, bone, reach)
    length = np.linalg.norm(rest[_END_BONE] - rest[_LOWER_BONE], axis=1)
    # fuse a measurement of the twist, with the bend's uncertainty, with the estimate without it
    spread2 = (_POINT_SD_M / (length * np.maximum(sine, 1e-3))) ** 2 + _HINGE_SD_RAD**2
    known = _OPEN_TWIST_RAD**2 / (_OPEN_TWIST_RAD**2 + spread2)
    turn = rotations.exp((known * twist)[:, None] * _unit(bone))
    quats[_UPPER_BONE] = rotations.multiply(untwisted, turn)
    quats[_LOWER_BONE] = _swung(quats[_UPPER_BONE], rest[_END_BONE] - rest[_LOWER_BONE], reach)
    quats[_END_BONE] = quats[_LOWER_BONE]
    quats[_TOES] = quats[_END_BONE[2:]]
    quats = rotations.canonical(quats)
    pose = Pose(np.zeros(3), quats)
    placed = joint_positions(body.skeleton, pose)[_UPPER_BONE]
    return Pose((p[_UPPER] - placed).mean(axis=0), quats)


def points_from_skeleton(body: MassSpringBody, pose: Pose) -> Floats:
    """The points (16,3) [m, world] of the body's skeleton in a pose, so that another tracker's body can start it."""
    joints = joint_positions(body.skeleton, pose)
    out = np.empty((N_POINTS, 3))
    out[JOINT_POINTS] = joints[JOINTS_OF_POINTS]

    def rotated(bone: str, point: int) -> Floats:
        j = INDEX[bone]
        offset = body.rest_m[point] - body.skeleton.rest_m[j]
        moved: Floats = joints[j] + rotations.rotate(pose.quats_xyzw[j], offset)
        return moved

    out[HEAD] = rotated("head", HEAD)
    for point in WAIST:
        out[point] = 0.5 * (rotated("spine", point) + rotated("chest", point))
    return out


def _trunk_turns(points_m: Floats, rest_m: Floats) -> Floats:
    """The turns (2,4) from the T-pose of the upper and the lower part of the trunk."""
    axes = np.stack([points_m, rest_m])[:, _TRUNK_POINTS]  # (2,2,4,3)
    x = _unit(axes[:, :, 0] - axes[:, :, 1])
    z = _unit(_cross(x, axes[:, :, :2].sum(axis=2) - axes[:, :, 2:].sum(axis=2)))
    z[:, 1] *= -1.0  # the waist is above the hips
    R = np.stack([x, _cross(z, x), z], axis=-1)
    return rotations.from_matrix(R[0] @ R[1].swapaxes(-1, -2))


def _cross(a: Floats, b: Floats) -> Floats:
    """Cross products (...,3); np.cross takes three times as long for so few."""
    out: Floats = a[..., _NEXT] * b[..., _LAST] - a[..., _LAST] * b[..., _NEXT]
    return out


def _unit(v: Floats) -> Floats:
    out: Floats = v / np.maximum(np.sqrt(np.vecdot(v, v)), 1e-9)[..., None]
    return out


def _swung(above_xyzw: Floats, rest_m: Floats, now_m: Floats) -> Floats:
    """The bone's turn (...,4): that above it (...,4), then the smallest that leads rest_m (...,3) to now_m (...,3)."""
    a, b = _unit(rest_m), _unit(rotations.rotate(rotations.inverse(above_xyzw), now_m))
    arc = np.concatenate([_cross(a, b), 1.0 + np.vecdot(a, b)[..., None]], axis=-1)
    # opposite directions have no smallest turn: any is as small
    opposite = np.vecdot(arc, arc)[..., None] < 1e-12
    arc = np.where(opposite, np.array([0.0, 0.0, 1.0, 0.0]), arc)
    return rotations.multiply(above_xyzw, rotations.canonical(arc))


def _bend_side(untwisted_xyzw: Floats, bone_m: Floats, reach_m: Floats) -> tuple[Floats, Floats]:
    """By how much each upper part is twisted (4,) [rad] for its joint to bend as it does, and the sine (4,) of the bend."""
    local = _unit(rotations.rotate(rotations.inverse(untwisted_xyzw), reach_m))
    along = _unit(bone_m)
    across = _cross(along, _BENDS_TO)
    p, q = np.vecdot(local, _cross(across, along)), np.vecdot(local, across)
    return np.arctan2(q, p), np.hypot(p, q)
