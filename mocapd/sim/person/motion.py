"""The person's motion as a pure function of time: keyframed limbs, stepping feet, slow sway."""

from dataclasses import dataclass

import numpy as np

from mocapd.body.skeleton import INDEX, N_JOINTS, global_from_local
from mocapd.geometry import rotations
from mocapd.sim.person.footsteps import FootTrack, foot_tracks
from mocapd.sim.person.leg_shape import leg_rotations
from mocapd.sim.person.monotone_cubic import MonotoneCubic, monotone_cubic
from mocapd.sim.person.poses import POSES, ArmDirections
from mocapd.sim.person_spec import PoseKeyframe
from mocapd.sim.scenario import Scenario
from mocapd.types import Floats, Pose, Skeleton

# How a bend or twist of the trunk is shared among its bones.
_TRUNK_SHARES = {"spine": 0.30, "chest": 0.35, "upperChest": 0.35}
_LEGS = ("UpperLeg", "LowerLeg", "Foot", "Toes")
# The shoulder girdle follows the upper arm's elevation above the hanging arm, up to this angle.
_GIRDLE_SHARE, _GIRDLE_MAX_RAD = 0.12, 0.35


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """Interpolators over one loop; build with `compile_motion`, ask with `pose_at`."""

    skeleton: Skeleton
    loop_s: float
    local_rad: MonotoneCubic  # (J*3,) rotation vectors relative to the parent bone
    root: MonotoneCubic  # x, z [m], yaw [rad], crouch [m]
    swings: tuple[tuple[int, Floats, float, float, float], ...]  # joint, vector, Hz, from, to
    sway: Floats  # (3, 4): cycles per loop, phase [rad], amplitude about x and z [rad]
    feet: tuple[FootTrack, FootTrack]  # left, right
    # (2*4,) per foot: how far it is off the floor, 0..1, and where [m]
    lifted: MonotoneCubic | None


def compile_motion(scenario: Scenario, skeleton: Skeleton) -> Motion:
    keys = scenario.motion.keyframes
    times = np.array([key.t_s for key in keys])
    local = np.stack([local_rotvecs(key).ravel() for key in keys])
    root, turn = _root_track(keys)
    loop_s = scenario.loop_s
    rng = np.random.default_rng([scenario.seed, 1])
    amplitude = np.radians(scenario.motion.sway_deg) * rng.uniform(0.4, 1.0, (3, 2))
    sway = np.concatenate(
        [np.array([[2.0], [3.0], [5.0]]), rng.uniform(0, 2 * np.pi, (3, 1)), amplitude], axis=1
    )
    root_of_t = _periodic(times, root, loop_s, np.array([0.0, 0.0, turn, 0.0]))
    return Motion(
        skeleton=skeleton,
        loop_s=loop_s,
        local_rad=_periodic(times, local, loop_s, np.zeros(local.shape[1])),
        root=root_of_t,
        swings=tuple(
            (INDEX[o.joint], np.radians(o.amplitude_deg), o.frequency_hz, o.from_s, o.to_s)
            for o in scenario.motion.oscillations
        ),
        sway=sway,
        feet=foot_tracks(root_of_t, skeleton, loop_s, turn),
        lifted=_foot_offsets(keys, times, loop_s),
    )


def _foot_offsets(keys: list[PoseKeyframe], times: Floats, loop_s: float) -> MonotoneCubic | None:
    """Where the keyframes place the feet themselves; None: nowhere."""
    feet = [(key.left_foot_m, key.right_foot_m) for key in keys]
    if not any(place is not None for both in feet for place in both):
        return None
    rows = [[(0.0, 0.0, 0.0, 0.0) if p is None else (1.0, *p) for p in both] for both in feet]
    values = np.array(rows).reshape(len(keys), 8)
    return _periodic(times, values, loop_s, np.zeros(8))


def pose_at(motion: Motion, t_s: float) -> Pose:
    """The pose at any time [s]; a time one loop later gives the same pose."""
    t = float(np.mod(t_s, motion.loop_s))
    local_rad = motion.local_rad(t).reshape(N_JOINTS, 3)
    local = rotations.exp(local_rad)
    for joint, vector, hz, start, end in motion.swings:
        if start < t < end:
            swing = _window(t, start, end) * np.sin(2 * np.pi * hz * (t - start))
            local[joint] = rotations.multiply(local[joint], rotations.exp(swing * vector))
    x, z, yaw, crouch = motion.root(t)
    cycles, phase, about_x, about_z = motion.sway.T
    wave = np.sin(2 * np.pi * cycles * t / motion.loop_s + phase)
    lean = np.array([(wave * about_x).sum(), 0.0, (wave * about_z).sum()])
    local[0] = rotations.multiply(rotations.exp(np.array([0.0, yaw, 0.0])), local[0])
    local[INDEX["spine"]] = rotations.multiply(local[INDEX["spine"]], rotations.exp(lean))
    quats = global_from_local(motion.skeleton, local)
    rest_height = motion.skeleton.rest_m[0, 1]
    root = np.array([x, rest_height - 0.012 - crouch, z])
    _plant_feet(motion, t, root, quats)
    return Pose(root, rotations.canonical(quats))


def _plant_feet(motion: Motion, t_s: float, root_m: Floats, quats: Floats) -> None:
    """Turn the legs (in place in quats) so that the feet are where they stand or step."""
    rest = motion.skeleton.rest_m
    hips = rotations.to_matrix(quats[0])
    lifted = np.zeros((2, 4)) if motion.lifted is None else motion.lifted(t_s).reshape(2, 4)
    for side, foot, lift in zip(("left", "right"), motion.feet, lifted, strict=True):
        joints = [INDEX[side + bone] for bone in _LEGS]
        hip, knee, ankle = rest[joints[:3]]
        at, yaw = foot.at(t_s)
        if lift[0] > 0.0:
            heading = float(np.arctan2(hips[0, 2], hips[2, 2]))
            place = rotations.exp(np.array([0.0, heading, 0.0]))
            wanted = rotations.rotate(
                place, np.array([ankle[0], 0.0, ankle[2]]) + lift[1:] / lift[0]
            )
            wanted += [root_m[0], ankle[1], root_m[2]]
            at = (1.0 - lift[0]) * at + lift[0] * wanted
            yaw += lift[0] * np.remainder(heading - yaw + np.pi, 2 * np.pi) - lift[0] * np.pi
        R = leg_rotations(
            root_m + hips @ (hip - rest[0]), knee - hip, ankle - knee, at, hips[:, 2], yaw
        )
        quats[joints] = rotations.from_matrix(R[[0, 1, 2, 2]])


def _window(t: float, start: float, end: float) -> float:
    """Rises and falls over 0.3 s, so that an oscillation begins and ends at rest."""
    edge = min(t - start, end - t) / 0.3
    return float(min(edge, 1.0) ** 2 * (3 - 2 * min(edge, 1.0)))


def _periodic(times: Floats, values: Floats, loop_s: float, step: Floats) -> MonotoneCubic:
    """Monotone cubic through the keys, repeated over three loops; `step` is the gain per loop."""
    around = np.concatenate([times + k * loop_s for k in range(-2, 4)])
    repeated = np.concatenate([values + k * step for k in range(-2, 4)])
    return monotone_cubic(around, repeated)


def _root_track(keys: list[PoseKeyframe]) -> tuple[Floats, float]:
    """x, z, yaw, crouch per keyframe, and the whole turns [rad] made in one loop."""
    x = z = yaw = 0.0
    rows = []
    for key in keys:
        x, z = key.at_m if key.at_m is not None else (x, z)
        yaw = key.yaw_deg if key.yaw_deg is not None else yaw
        rows.append([x, z, np.radians(yaw), POSES[key.pose].crouch_m])
    out = np.array(rows)
    turn = 2 * np.pi * np.round((out[-1, 2] - out[0, 2]) / (2 * np.pi))
    return out, float(turn)


def local_rotvecs(key: PoseKeyframe) -> Floats:
    """Rotation vectors (J,3) [rad] relative to the parent bones."""
    pose = POSES[key.pose]
    out = np.zeros((N_JOINTS, 3))
    forwards, to_left = key.lean_deg
    bend = np.radians([forwards + pose.bend_deg, key.twist_deg, -to_left])
    for bone, share in _TRUNK_SHARES.items():
        out[INDEX[bone]] = share * bend
    out[INDEX["neck"]] = -0.25 * bend
    out[INDEX["head"]] = -0.25 * bend
    for side, arm in (("left", key.left_arm or pose.left), ("right", key.right_arm or pose.right)):
        girdle, upper, lower = _arm_quats(side, arm)
        out[INDEX[side + "Shoulder"]] = rotations.log(girdle)
        out[INDEX[side + "UpperArm"]] = rotations.log(upper)
        out[INDEX[side + "LowerArm"]] = rotations.log(lower)
    return out


def _arm_quats(side: str, arm: ArmDirections) -> tuple[Floats, Floats, Floats]:
    """Local rotations of shoulder girdle, upper arm, forearm for the two directions.

    The elbow is a hinge about the upper arm's own Y, so the forearm's direction sets the twist.
    """
    outward = 1.0 if side == "left" else -1.0
    u, f = (np.array(v) / np.linalg.norm(v) for v in arm)
    cosine = float(np.clip(u @ f, -1.0, 1.0))
    across = f - cosine * u
    size = float(np.linalg.norm(across))
    x_axis = outward * u
    # a nearly straight arm takes the twist that keeps the elbow's inside forward or up
    hint = np.array([0.0, 0.0, 1.0]) if abs(u[2]) < 0.8 else np.array([0.0, 1.0, 0.0])
    hint = hint - (hint @ u) * u
    weight = np.clip(size / 0.35, 0.0, 1.0)
    z_axis = weight * across / max(size, 1e-9) + (1 - weight) * hint / np.linalg.norm(hint)
    z_axis -= (z_axis @ u) * u
    z_axis /= np.linalg.norm(z_axis)
    frame = np.stack([x_axis, np.cross(z_axis, x_axis), z_axis], axis=-1)
    upper_global = rotations.from_matrix(frame)
    lower = rotations.multiply(
        rotations.inverse(upper_global),
        rotations.multiply(_shortest(u, f), upper_global),
    )
    elevation = float(np.arcsin(np.clip(u[1], -1.0, 1.0))) + np.pi / 3
    lift = min(_GIRDLE_SHARE * max(elevation, 0.0), _GIRDLE_MAX_RAD)
    girdle = rotations.exp(np.array([0.0, 0.0, outward * lift]))
    return girdle, rotations.multiply(rotations.inverse(girdle), upper_global), lower


def _shortest(a: Floats, b: Floats) -> Floats:
    """The rotation of the shortest arc from unit vector a to b."""
    axis = np.cross(a, b)
    return rotations.canonical(np.append(axis, 1.0 + a @ b))
