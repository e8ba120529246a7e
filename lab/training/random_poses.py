"""Poses of any sort: those of clips, put together of two of them, and made up within what joints do."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lab.simulated.motion_clip import MotionClip
from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import (
    INDEX,
    N_JOINTS,
    OTHER_SIDE,
    global_from_local,
    joint_positions,
    local_from_global,
)
from mocapd.geometry import rotations
from mocapd.sim.person.leg_shape import leg_rotations
from mocapd.sim.person.motion import local_rotvecs
from mocapd.sim.person.poses import POSES, ArmDirections
from mocapd.sim.person_spec import PoseKeyframe
from mocapd.types import Floats, Pose, Skeleton

# Shares of poses: as in a clip; of two clips; the others are made up
_OF_CLIP, _OF_TWO = 0.28, 0.4
# Shares of made-up arms, each with those before it: both forwards (in a squat), like a named pose
_FORWARDS, _FORWARDS_SUNK, _LIKE_NAMED = 0.1, 0.4, 0.35
_BEFORE = 0.35  # share of the other arms whose hand is before the trunk or the face
# Shares of feet: lifted; of those, with those before it: kicked forwards, a leg flung anywhere; of feet that stand; of squats
_LIFTED, _KICKS, _FLUNG, _LUNGES, _TIPTOES = 0.4, 0.5, 0.75, 0.12, 0.3
_SQUATS = 0.3  # hips as far down
_KNEES_LEAD = 0.5  # share of squats whose knees do not heed where the feet point
_FOOT_M = 0.18  # from the ankle to the toes
_LEGS = ("UpperLeg", "LowerLeg", "Foot", "Toes")
_ARMS = ("Shoulder", "UpperArm", "LowerArm", "Hand")
_FEET = [INDEX[side + joint] for side in SIDES for joint in ("Foot", "Toes")]
_MIRROR = np.array([1.0, -1.0, -1.0, 1.0])  # of a rotation, at x = 0
# of the trunk and the head, in the chest's frame above the hips [m]: no arm is in there
_TRUNK_M, _TRUNK_FROM_TO_M = (0.17, 0.14), (-0.2, 0.5)
_HEAD_M, _HEAD_RADIUS_M = np.array([0.0, 0.65, 0.03]), 0.14
_SHOULDER_M, _UPPER_M, _FORE_M = np.array([0.17, 0.42, 0.0]), 0.29, 0.25
_SWING_RAD_S = {"arm": 3.5, "leg": 2.0}  # of limbs that are made to move
_SWING_SPREAD = 0.6  # of its logarithm: seldom as fast as a kick
# of hands before the trunk, in the frame of the chest, outwards, up and forwards [m]
_HAND_FROM_M, _HAND_TO_M = (-0.25, 0.02, 0.14), (0.22, 0.68, 0.42)


@dataclass(frozen=True, slots=True, eq=False)
class MovingPose:
    """A pose while a shutter is open: when it opens, when it closes, and between."""

    opened: Pose
    closed: Pose
    middle: Pose


def random_pose(
    rng: np.random.Generator, skeleton: Skeleton, clips: Sequence[MotionClip], shutter_s: float
) -> MovingPose:
    """Somebody at the origin, on the floor or, seldom, above it, who faces anywhere."""
    kind = rng.uniform()
    if kind < _OF_CLIP:
        quats, turned = _of_clip(rng, clips, shutter_s)
        if rng.uniform() < 0.5:
            quats, turned = quats[OTHER_SIDE] * _MIRROR, turned[OTHER_SIDE] * [1.0, -1.0, -1.0]
    else:
        quats = _of_two(rng, skeleton, clips) if kind < _OF_TWO else _made_up(rng, skeleton)
        turned = _swings(rng, shutter_s) if rng.uniform() < 0.5 else np.zeros((N_JOINTS, 3))
    quats = rotations.canonical(quats)
    half, whole = (rotations.multiply(rotations.exp(share * turned), quats) for share in (0.5, 1.0))
    joints_m = joint_positions(skeleton, Pose(np.zeros(3), quats))
    lowest_m = (joints_m - skeleton.rest_m)[_FEET, 1].min()
    jump_m = rng.uniform(0.0, 0.25) if rng.uniform() < 0.08 else 0.0
    root_m = np.array([0.0, jump_m - lowest_m, 0.0])
    way_m = rng.normal(0.0, 0.5, 3) * shutter_s
    return MovingPose(
        Pose(root_m - 0.5 * way_m, quats),
        Pose(root_m + 0.5 * way_m, rotations.canonical(whole)),
        Pose(root_m, rotations.canonical(half)),
    )


def _of_clip(
    rng: np.random.Generator, clips: Sequence[MotionClip], over_s: float
) -> tuple[Floats, Floats]:
    """Global rotations (J,4) of a frame, turned to anywhere, and by how much each goes on turning (J,3) [rad]."""
    clip = clips[int(rng.integers(len(clips)))]
    i = int(rng.integers(len(clip.hips_m) - 1))
    heading = rotations.exp(np.array([0.0, rng.uniform(-np.pi, np.pi), 0.0]))
    now, then = (rotations.multiply(heading, clip.global_xyzw[k]) for k in (i, i + 1))
    turned = rotations.log(rotations.multiply(then, rotations.inverse(now)))
    return now, turned * clip.rate_hz * over_s


def _of_two(rng: np.random.Generator, skeleton: Skeleton, clips: Sequence[MotionClip]) -> Floats:
    """The legs, or one arm, of another frame."""
    one, other = (local_from_global(skeleton, _of_clip(rng, clips, 0.0)[0]) for _ in range(2))
    bones = [side + bone for side in SIDES for bone in _LEGS]
    if rng.uniform() > 0.7:
        bones = ["left" + bone for bone in _ARMS]
    taken = [INDEX[bone] for bone in bones]
    one[taken] = other[taken]
    return global_from_local(skeleton, one)


def _made_up(rng: np.random.Generator, skeleton: Skeleton) -> Floats:
    """Arms anywhere, the hips down to a deep squat, a foot lifted."""
    sunk = 0.68 * rng.uniform() ** 0.7 if rng.uniform() < 0.45 else rng.uniform(0.0, 0.08)
    arms = rng.uniform()
    if arms < (_FORWARDS_SUNK if sunk > 0.15 else _FORWARDS):
        left, right = _forwards(rng)
    elif arms < _LIKE_NAMED:
        left, right = _like_named(rng)
    else:
        left = _like_named(rng)[0] if rng.uniform() < 0.2 else _free_arm(rng, 1.0)
        right = _like_named(rng)[1] if rng.uniform() < 0.2 else _free_arm(rng, -1.0)
    forwards_deg = rng.normal(0.0, 9.0) + sunk * rng.uniform(0.0, 70.0)
    if rng.uniform() < 0.12:
        forwards_deg += rng.uniform(0.0, 60.0)
    vectors = local_rotvecs(
        PoseKeyframe(
            t_s=0.0, left_arm=left, right_arm=right, lean_deg=(forwards_deg, rng.normal(0.0, 8.0)),
            twist_deg=rng.normal(0.0, 15.0),
        )
    )  # fmt: skip
    vectors[INDEX["neck"]] += rng.normal(0.0, [0.15, 0.35, 0.1])
    vectors[INDEX["head"]] += rng.normal([0.05, 0.0, 0.0], [0.15, 0.2, 0.08])
    local = rotations.exp(vectors)
    yaw_rad = rng.uniform(-np.pi, np.pi)
    tilt_rad = np.array(
        [rng.normal(0.0, 0.08) + sunk * rng.uniform(0.0, 0.9), 0.0, rng.normal(0.0, 0.07)]
    )
    local[0] = rotations.multiply(
        rotations.exp(np.array([0.0, yaw_rad, 0.0])), rotations.exp(tilt_rad)
    )
    quats = global_from_local(skeleton, local)
    if not _place_feet(rng, skeleton, quats, yaw_rad, sunk):
        return _made_up(rng, skeleton)
    return quats


def _like_named(rng: np.random.Generator) -> tuple[ArmDirections, ArmDirections]:
    """The arms of one of the named poses, about."""
    names = list(POSES)
    pose = POSES[names[rng.integers(len(names))]]

    def about(arm: ArmDirections) -> ArmDirections:
        upper, fore = (_unit(np.array(d)) + rng.normal(0.0, 0.2, 3) for d in arm)
        return _direction(upper), _direction(fore)

    return about(pose.left), about(pose.right)


def _forwards(rng: np.random.Generator) -> tuple[ArmDirections, ArmDirections]:
    """Both arms in front, stretched or bent, towards each other or apart: so people squat, reach and hold things."""
    down, bent = rng.normal(-0.1, 0.4), rng.uniform(0.0, 1.2) * (rng.uniform() < 0.6)
    inwards, spread = rng.uniform(-0.2, 0.8), rng.normal(0.05, 0.25)
    raised = rng.normal(0.1, 0.35)

    def arm(outwards: float) -> ArmDirections:
        upper = _unit(
            np.array([outwards * spread, down - 0.5 * bent, 1.0]) + rng.normal(0.0, 0.1, 3)
        )
        fore = _unit(np.array([-outwards * inwards * bent, raised * bent, 1.0]))
        return _direction(upper), _direction(_unit(upper + 1.5 * bent * fore))

    return arm(1.0), arm(-1.0)


def _free_arm(rng: np.random.Generator, outwards: float) -> ArmDirections:
    return (_before_trunk if rng.uniform() < _BEFORE else _any_arm)(rng, outwards)


def _before_trunk(rng: np.random.Generator, outwards: float) -> ArmDirections:
    """Directions of upper arm and forearm that hold the hand before the trunk or the face, the elbow mostly down."""
    while True:
        reach = rng.uniform(_HAND_FROM_M, _HAND_TO_M) - _SHOULDER_M
        length_m = float(np.linalg.norm(reach))
        if not 0.15 < length_m < _UPPER_M + _FORE_M:
            continue
        down = reach / length_m
        pole = rng.normal([0.5, -0.8, -0.2], 0.5)
        pole = _unit(pole - (pole @ down) * down)
        # law of cosines: as far along the reach is the elbow
        along_m = (_UPPER_M**2 - _FORE_M**2 + length_m**2) / (2.0 * length_m)
        elbow = along_m * down + np.sqrt(max(_UPPER_M**2 - along_m**2, 0.0)) * pole
        fore = reach - elbow
        at_m = _SHOULDER_M + elbow
        if not any(_in_body(at_m + share * fore) for share in (0.0, 0.5, 1.0)):
            side = np.array([outwards, 1.0, 1.0])
            return _direction(elbow * side), _direction(fore * side)


def _any_arm(rng: np.random.Generator, outwards: float) -> ArmDirections:
    """Directions of upper arm and forearm that are in nothing."""
    while True:
        upper = _unit(_unit(rng.normal(size=3)) - [0.0, 0.3, 0.0])
        fore = _unit(rng.uniform(0.0, 1.6) * _unit(rng.normal(size=3)) + upper)
        behind = fore[0] < 0.0 and fore[2] < -0.3
        if upper[0] < -0.35 or upper[2] < -0.6 or upper @ fore < -0.8 or behind:
            continue
        elbow = _SHOULDER_M + _UPPER_M * upper
        if not any(_in_body(elbow + share * _FORE_M * fore) for share in (0.0, 0.5, 1.0)):
            side = np.array([outwards, 1.0, 1.0])
            return _direction(upper * side), _direction(fore * side)


def _in_body(point_m: Floats) -> bool:
    low_m, high_m = _TRUNK_FROM_TO_M
    wide_m, deep_m = _TRUNK_M
    in_trunk = (point_m[0] / wide_m) ** 2 + (point_m[2] / deep_m) ** 2 < 1.0
    in_head = float(np.linalg.norm(point_m - _HEAD_M)) < _HEAD_RADIUS_M
    return in_head or (bool(in_trunk) and low_m < point_m[1] < high_m)


def _place_feet(
    rng: np.random.Generator, skeleton: Skeleton, quats: Floats, yaw_rad: float, sunk: float
) -> bool:
    """Turn the legs (in place in quats) so that feet stand or one is lifted; whether they reach there."""
    rest_m = skeleton.rest_m
    root_m = np.array([0.0, rest_m[0, 1] * (1.0 - sunk) - 0.01, 0.0])
    hips, heading = (
        rotations.to_matrix(quats[0]),
        rotations.to_matrix(rotations.exp(np.array([0.0, yaw_rad, 0.0]))),
    )
    lifted = SIDES[rng.integers(2)] if rng.uniform() < _LIFTED else None
    apart_m, step_m = abs(rng.normal(0.0, 0.1 + 0.15 * sunk)), rng.normal(0.0, 0.14)
    if rng.uniform() < _LUNGES:
        step_m = rng.normal(0.0, 0.4)
    turned_rad = rng.normal(0.15, 0.2) + sunk * rng.uniform(0.0, 0.9)
    knees_lead = sunk > _SQUATS and rng.uniform() < _KNEES_LEAD
    # knees point as far, or between there and the feet
    splay_rad = rng.uniform(0.6, 2.5) if knees_lead else sunk * rng.uniform(-0.3, 3.5)
    heel_m = rng.uniform(0.0, 0.25) * sunk if rng.uniform() < _TIPTOES else 0.0
    lifted_as = rng.uniform()
    for side, outwards in zip(SIDES, (1.0, -1.0), strict=True):
        joints = [INDEX[side + bone] for bone in _LEGS]
        hip, knee, ankle = rest_m[joints[:3]]
        ahead_m = outwards * step_m * (rng.uniform() < 0.8) + 0.05 * sunk
        off_m = np.array([outwards * apart_m, 0.0, ahead_m]) + rng.normal(0.0, [0.03, 0.0, 0.03])
        knee_rad = outwards * (splay_rad + rng.normal(0.0, 0.15))
        splayed = rotations.exp(np.array([0.0, knee_rad, 0.0]))
        forwards = rotations.rotate(splayed, hips[:, 2])
        raised_m = 0.0 if side == lifted else heel_m + 0.02 * abs(rng.normal()) * sunk
        off_m[1] += raised_m
        if side == lifted:
            off_m += (
                [rng.normal(0.0, 0.25), rng.uniform(0.2, 1.3), rng.uniform(0.3, 1.0)]
                if lifted_as < _KICKS
                else [rng.normal(0.0, 0.2), rng.uniform(0.03, 0.8), rng.normal(0.1, 0.35)]
            )
        at_m = heading @ (np.array([ankle[0], 0.0, ankle[2]]) + off_m) + [0.0, ankle[1], 0.0]
        foot_rad = yaw_rad + outwards * (turned_rad + rng.normal(0.0, 0.1))
        R = leg_rotations(
            root_m + hips @ (hip - rest_m[0]), knee - hip, ankle - knee, at_m, forwards,
            yaw_rad + knee_rad if knees_lead else foot_rad,
        )  # fmt: skip
        if not np.isfinite(R).all():
            return False
        R[2] = rotations.to_matrix(rotations.exp(np.array([0.0, foot_rad, 0.0])))
        if side == lifted and _KICKS <= lifted_as < _FLUNG:
            R[:2] = _flung(rng, hips, outwards)
        if side == lifted:  # a foot in the air hangs on its shank
            R[2] = R[1] @ rotations.to_matrix(
                rotations.exp(np.array([rng.uniform(-0.2, 0.8), 0.0, 0.0]))
            )
        elif raised_m > 0.0:
            tipped = np.array([np.arcsin(min(raised_m / _FOOT_M, 1.0)), 0.0, 0.0])
            R[2] = R[2] @ rotations.to_matrix(rotations.exp(tipped))
        quats[joints] = rotations.from_matrix(R[[0, 1, 2, 2]])
    return True


def _flung(rng: np.random.Generator, hips: Floats, outwards: float) -> Floats:
    """Rotations (2,3,3) of thigh and shank below these hips (3,3), as far as legs go."""
    thigh = np.array(
        [
            rng.uniform(-2.2, 0.7),
            outwards * rng.uniform(-0.5, 0.6),
            outwards * rng.uniform(-0.4, 1.0),
        ]
    )
    shank = np.array([rng.uniform(0.0, 2.3) * rng.uniform(), 0.0, 0.0])
    upper = hips @ rotations.to_matrix(rotations.exp(thigh))
    return np.stack([upper, upper @ rotations.to_matrix(rotations.exp(shank))])


def _swings(rng: np.random.Generator, over_s: float) -> Floats:
    """By how much limbs turn (J,3) [rad], the farther from the body the more."""
    out = np.zeros((N_JOINTS, 3))
    for limb, bones in (("arm", _ARMS[1:]), ("leg", _LEGS)):
        for side in SIDES:
            speed_rad_s = _SWING_RAD_S[limb] * rng.lognormal(0.0, _SWING_SPREAD)
            turn_rad = rng.normal(0.0, speed_rad_s, 3) * over_s
            for bone in bones:
                out[INDEX[side + bone]] = turn_rad * (1.0 if "Upper" in bone else 1.5)
    return out


def _unit(v: Floats) -> Floats:
    out: Floats = v / np.linalg.norm(v)
    return out


def _direction(v: Floats) -> tuple[float, float, float]:
    x, y, z = _unit(v).tolist()
    return x, y, z
