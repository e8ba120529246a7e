"""People who do not stand: where they put their limbs, and how they move there, for simulated sessions."""

from dataclasses import dataclass

import numpy as np

from mocapd.body.skeleton import INDEX, N_JOINTS, global_from_local, joint_positions
from mocapd.fit.limbs.two_bone_ik import LIMBS, two_bone_pose
from mocapd.geometry import rotations
from mocapd.sim.person.motion import local_rotvecs
from mocapd.sim.person.poses import Direction
from mocapd.sim.person_spec import PoseKeyframe
from mocapd.sim.world import Performed, PoseAt
from mocapd.types import Floats, Pose, Skeleton

# how far the body reaches below each of these joints [m]
_BELOW_M = {
    "hips": 0.12, "chest": 0.12, "neck": 0.06, "head": 0.10, "leftLowerLeg": 0.06, "rightLowerLeg": 0.06,
    "leftFoot": 0.07, "rightFoot": 0.07, "leftToes": 0.02, "rightToes": 0.02, "leftHand": 0.03, "rightHand": 0.03,
}  # fmt: skip
_HANGS: tuple[Direction, Direction] = ((0.25, -1.0, 0.05), (0.15, -1.0, 0.3))


@dataclass(frozen=True, slots=True)
class LowStance:
    """Directions of the left thigh, shank and foot, upper arm and forearm: +X the person's left, +Y up, +Z forwards.

    The right side mirrors them. lean_deg: of the trunk, forwards; hips_deg: of the whole body, forwards (a rotation about
    the person's own +X); arms are in the frame of the chest.
    """

    thigh: Direction = (0.1, -1.0, 0.0)
    shank: Direction = (0.0, -1.0, -0.02)
    foot: Direction = (0.15, 0.0, 1.0)
    upper_arm: Direction = _HANGS[0]
    forearm: Direction = _HANGS[1]
    lean_deg: float = 0.0
    hips_deg: float = 0.0


STANCES = {
    "stands": LowStance(),
    "sits": LowStance(
        (0.18, 0.02, 1.0), (0.0, -1.0, 0.05), upper_arm=(0.2, -0.9, 0.35), forearm=(-0.1, -0.25, 1.0), lean_deg=6.0
    ),
    "sits_low": LowStance(
        (0.22, 0.3, 1.0), (0.0, -1.0, -0.1), upper_arm=(0.25, -0.8, 0.5), forearm=(-0.2, 0.1, 1.0), lean_deg=12.0
    ),
    "kneels": LowStance((0.12, -1.0, 0.05), (0.0, -0.12, -1.0), (0.0, -0.25, -1.0)),
    "sits_on_heels": LowStance(
        (0.25, -0.22, 1.0), (0.0, -0.05, -1.0), (0.0, -0.2, -1.0), upper_arm=(0.2, -0.95, 0.3), forearm=(-0.1, -0.5, 1.0)
    ),
    "squats": LowStance(
        (0.45, 0.15, 1.0), (0.0, -1.0, -0.5), (0.4, 0.0, 1.0), upper_arm=(0.2, -0.4, 0.9), forearm=(-0.3, 0.1, 1.0),
        lean_deg=25.0, hips_deg=12.0,
    ),
    "crouches": LowStance(
        (0.2, -0.55, 1.0), (0.0, -1.0, -0.45), upper_arm=(0.15, -0.8, 0.6), forearm=(0.0, -0.5, 1.0), lean_deg=35.0,
        hips_deg=25.0,
    ),
    "lies": LowStance(
        (0.12, -1.0, 0.06), (0.02, -1.0, -0.06), (0.1, -0.5, 1.0), upper_arm=(0.5, -0.9, 0.0), forearm=(0.3, -1.0, 0.3),
        hips_deg=-90.0,
    ),
    "cross_legged": LowStance(
        (0.75, 0.05, 0.7), (-0.95, -0.12, -0.1), (-0.7, -0.3, 0.6), upper_arm=(0.3, -0.9, 0.35),
        forearm=(-0.05, -0.35, 1.0), lean_deg=10.0,
    ),
}  # fmt: skip


def performed(
    stance: LowStance, yaw_deg: float = 0.0, at_m: tuple[float, float] = (0.0, 0.0)
) -> Performed:
    """Somebody who stays in this stance, facing yaw_deg (0 is +Z), leans to and fro and moves the arms."""

    def by(skeleton: Skeleton) -> PoseAt:
        return lambda t_s: _pose_at(stance, skeleton, np.radians(yaw_deg), at_m, t_s)

    return by


def hips_height_m(stance: LowStance, skeleton: Skeleton) -> float:
    """Of somebody in this stance on the floor."""
    return float(_pose_at(stance, skeleton, 0.0, (0.0, 0.0), 0.0).root_m[1])


def _pose_at(
    stance: LowStance, skeleton: Skeleton, yaw_rad: float, at_m: tuple[float, float], t_s: float
) -> Pose:
    swing = np.sin(2.0 * np.pi * 0.4 * t_s + np.array([0.0, 1.7, 3.1]))
    local = _local(stance, skeleton, swing)
    local[0] = rotations.multiply(rotations.exp(np.array([0.0, yaw_rad, 0.0])), local[0])
    quats = global_from_local(skeleton, local)
    joints_m = joint_positions(skeleton, Pose(np.zeros(3), quats))
    # the legs alone hold the body up: arms that swing do not lift it
    held = {name: below for name, below in _BELOW_M.items() if "Hand" not in name}
    under_m = min(joints_m[INDEX[name], 1] - below for name, below in held.items())
    return Pose(np.array([at_m[0], -under_m, at_m[1]]), rotations.canonical(quats))


def _local(stance: LowStance, skeleton: Skeleton, swing: Floats) -> Floats:
    """Rotations (J,4); swing (3,): of the trunk and of each arm, -1..1."""
    arms = []
    for outwards, share in ((1.0, swing[1]), (-1.0, swing[2])):
        moved = np.array([[0.15, 0.15, 0.1], [0.0, 0.45, 0.1]]) * share
        upper, fore = (np.array([stance.upper_arm, stance.forearm]) + moved) * [outwards, 1.0, 1.0]
        arms.append((tuple(upper.tolist()), tuple(fore.tolist())))
    key = PoseKeyframe(
        t_s=0.0, left_arm=arms[0], right_arm=arms[1], lean_deg=(stance.lean_deg + 4.0 * swing[0], 3.0 * swing[1]),
        twist_deg=6.0 * swing[0],
    )  # fmt: skip
    local = rotations.exp(local_rotvecs(key))
    rest_m = skeleton.rest_m
    still = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    for side, outwards in (("left", 1.0), ("right", -1.0)):
        limb, mirror = LIMBS[f"{side}_leg"], np.array([outwards, 1.0, 1.0])
        places_m = rest_m.copy()
        for joint, above, along in (
            (limb.lower, limb.upper, stance.thigh), (limb.end, limb.lower, stance.shank),
        ):  # fmt: skip
            way = np.array(along) * mirror
            length_m = np.linalg.norm(rest_m[joint] - rest_m[above])
            places_m[joint] = places_m[above] + length_m * way / np.linalg.norm(way)
        bent = two_bone_pose(limb, rest_m, rest_m, still, places_m)
        assert bent is not None
        local[[limb.upper, limb.lower]] = bent
        shank = rotations.multiply(bent[0], bent[1])
        local[limb.end] = rotations.multiply(
            rotations.inverse(shank), _turned(np.array(stance.foot) * mirror)
        )
    tipped = rotations.exp(np.array([np.radians(stance.hips_deg), 0.0, 0.0]))
    local[0] = tipped
    if (
        stance.hips_deg > 0.0
    ):  # the hips tip beneath a body on its feet: its legs stay where they are
        for side in ("left", "right"):
            upper = INDEX[side + "UpperLeg"]
            local[upper] = rotations.multiply(rotations.inverse(tipped), local[upper])
    return rotations.canonical(local)


def _turned(ahead: Floats) -> Floats:
    """The rotation (4,) of a foot that points ahead, its sole as far down as that allows."""
    z = ahead / np.linalg.norm(ahead)
    up = np.array([0.0, 1.0, 0.0]) if abs(z[1]) < 0.9 else np.array([0.0, 0.0, 1.0])
    x = np.cross(up, z)
    x /= np.linalg.norm(x)
    return np.asarray(rotations.from_matrix(np.stack([x, np.cross(z, x), z], axis=-1)))
