"""Upper-body poses over 3-D orientations, spread evenly by a Sobol sequence.

[Wang 2011, section 5.2, step 2] blends generic action poses linearly; so do we, with key poses of our
own, and fill up with arms drawn from the joints' whole range. A pose beyond the joint limits or with a
forearm inside the trunk is left out.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.body.joint_limits import from_swing_twist, swing_twist
from mocapd.body.pose_space import upper_body
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.geometry import rotations
from mocapd.shirt.pose_database.key_poses import ARMS, TORSOS, arm_rotations
from mocapd.types import Floats, Singles

# A camera sees the person upright and from the front: its y is down and its z away from it.
CAMERA_FROM_FACING_XYZW = np.array([1.0, 0.0, 0.0, 0.0])
_SPINE = ("spine", "chest", "upperChest")
_ARM_DIMENSIONS = 13
_DIMENSIONS = 12 + 2 * _ARM_DIMENSIONS
_MIRROR = np.array([1.0, -1.0, -1.0, 1.0])


@dataclass(frozen=True, slots=True)
class SamplingParams:
    """Spread of the poses. Part of the database's content hash: changing a value rebuilds it."""

    front_share: float = 0.6  # of the poses with a yaw of at most front_yaw_deg
    front_yaw_deg: float = 75.0
    pitch_deg: tuple[float, float] = (-15.0, 40.0)  # camera looking up .. down at the person
    roll_deg: float = 12.0  # of the camera
    lean_deg: tuple[float, float] = (-15.0, 40.0)  # of the hips, back .. forwards
    lean_side_deg: float = 15.0
    symmetric_share: float = 0.2  # of the poses with both arms alike
    key_share: float = 0.7  # of the arms that are blends of key poses
    jitter_deg: float = 12.0  # about a blend of key poses
    pronation_deg: float = 50.0
    limit_slack_deg: float = 8.0  # a blend may go beyond the joint limits by this


@dataclass(frozen=True, slots=True, eq=False)
class PoseSet:
    """N poses: local_xyzw (N,J,4), rotations relative to the parent bone, the root's being identity;
    camera_from_root_xyzw (N,4), the root's rotation in a camera that looks straight at the person."""

    local_xyzw: Singles
    camera_from_root_xyzw: Singles

    def __len__(self) -> int:
        return len(self.local_xyzw)


class LowDispersionCube:
    """Points of a scrambled Sobol sequence in the parameters' unit cube, drawn piece by piece."""

    def __init__(self, seed: int) -> None:
        # costs half a second and 40 MB, which only the building of the database needs
        from scipy.stats import qmc

        self._sobol = qmc.Sobol(_DIMENSIONS, rng=np.random.default_rng(seed))

    def draw(self, power: int) -> Floats:
        """The next 2**power points (2**power, D); always the same power keeps the sequence balanced."""
        return np.asarray(self._sobol.random(2**power))


def random_cube(count: int, seed: int) -> Floats:
    """`count` independent random points (count, D): what low dispersion is measured against."""
    return np.random.default_rng(seed).random((count, _DIMENSIONS))


def poses_from_cube(cube: Floats, params: SamplingParams) -> PoseSet:
    """The poses that parameters (N,D) in 0..1 stand for, without those that cut into the trunk."""
    n = len(cube)
    local = np.tile(rotations.IDENTITY_XYZW, (n, N_JOINTS, 1))
    turn = _torso(cube[:, 5:11])
    for name in _SPINE:
        local[:, INDEX[name]] = turn
    left = cube[:, 12 : 12 + _ARM_DIMENSIONS]
    right = cube[:, 12 + _ARM_DIMENSIONS :]
    right = np.where(cube[:, 11:12] < params.symmetric_share, left, right)
    for side, block, mirror in (("left", left, np.ones(4)), ("right", right, _MIRROR)):
        collar, upper, lower = _arm(block, params)
        local[:, INDEX[side + "Shoulder"]] = collar * mirror
        local[:, INDEX[side + "UpperArm"]] = upper * mirror
        local[:, INDEX[side + "LowerArm"]] = lower * mirror
    keep = ~(_cuts_trunk(local) | _beyond_limits(local, np.radians(params.limit_slack_deg)))
    return PoseSet(
        local[keep].astype(np.float32), _orientation(cube[:, :5], params)[keep].astype(np.float32)
    )


def _about(axis: int, angle_rad: Floats) -> Floats:
    vector = np.zeros((*angle_rad.shape, 3))
    vector[..., axis] = angle_rad
    return rotations.exp(vector)


def _map_to_range(u: Floats, low: float, high: float) -> Floats:
    """0..1 to low..high with the middle of the cube at 0 and twice as dense there."""
    s = 2.0 * u - 1.0
    s = 0.5 * (s + s * np.abs(s))
    return np.where(s < 0.0, -low * s, high * s)


def _orientation(u: Floats, params: SamplingParams) -> Floats:
    """camera_from_root (N,4): camera's roll and pitch, the person's yaw, lean of the hips."""
    front = np.radians(params.front_yaw_deg)
    s = 2.0 * u[:, 0] - 1.0
    inside = np.abs(s) <= params.front_share
    beyond = (np.abs(s) - params.front_share) / (1.0 - params.front_share)
    yaw = np.where(
        inside, s / params.front_share * front, np.sign(s) * (front + beyond * (np.pi - front))
    )
    low, high = np.radians(params.pitch_deg)
    q = _about(2, np.radians(params.roll_deg) * (2.0 * u[:, 2] - 1.0))
    # a camera that looks down by an angle sees the person's head come nearer
    q = rotations.multiply(q, _about(0, low + (high - low) * u[:, 1]))
    q = rotations.multiply(q, CAMERA_FROM_FACING_XYZW)
    q = rotations.multiply(q, _about(1, yaw))
    low, high = np.radians(params.lean_deg)
    q = rotations.multiply(q, _about(0, _map_to_range(u[:, 3], low, high)))
    side = np.radians(params.lean_side_deg)
    return rotations.canonical(
        rotations.multiply(q, _about(2, _map_to_range(u[:, 4], -side, side)))
    )


def _torso(u: Floats) -> Floats:
    """Rotation of each of the three joints of the spine (N,4): a blend of two key poses, and jitter."""
    keys = np.radians(np.array(list(TORSOS.values())))
    a, b = (keys[np.minimum((u[:, i] * len(keys)).astype(int), len(keys) - 1)] for i in (0, 1))
    vector = a + u[:, 2:3] * (b - a) + np.radians([16.0, 16.0, 10.0]) * (2.0 * u[:, 3:6] - 1.0)
    return rotations.exp(vector / len(_SPINE))


def _arm(u: Floats, params: SamplingParams) -> tuple[Floats, Floats, Floats]:
    """Local rotations (N,4) of collar bone, upper arm and forearm of left arms."""
    keys = [arm_rotations(name) for name in ARMS]
    upper_keys, lower_keys = (np.array(q) for q in zip(*keys, strict=True))
    picks = [np.minimum((u[:, i] * len(keys)).astype(int), len(keys) - 1) for i in range(3)]
    # uniform over the triangle of the three keys
    r = np.sqrt(u[:, 3])
    weights = np.stack([1.0 - r, r * (1.0 - u[:, 4]), r * u[:, 4]], axis=-1)
    upper = _blend(np.stack([upper_keys[p] for p in picks], 1), weights)
    lower = _blend(np.stack([lower_keys[p] for p in picks], 1), weights)
    jitter = np.radians(params.jitter_deg)
    upper = rotations.multiply(upper, rotations.exp(jitter * (2.0 * u[:, 5:8] - 1.0)))
    lower = rotations.multiply(_about(1, -jitter * (2.0 * u[:, 8] - 1.0)), lower)

    # the joints' whole range: twist x, forwards -y, up z
    low = np.radians([-110.0, -125.0, -90.0])
    high = np.radians([80.0, 45.0, 90.0])
    free = from_swing_twist(low + (high - low) * u[:, 5:8], axis=0)
    bend = _about(1, -np.radians(145.0) * u[:, 8])
    blended = (u[:, 9] < params.key_share)[:, None]
    upper, lower = np.where(blended, upper, free), np.where(blended, lower, bend)
    pronation = np.radians(params.pronation_deg)
    lower = rotations.multiply(lower, _about(0, pronation * (2.0 * u[:, 10] - 1.0)))

    # the collar bone follows the arm: about a fifth of its rise above 30 degrees of elevation
    direction = rotations.rotate(upper, np.array([1.0, 0.0, 0.0]))
    elevation = np.arccos(np.clip(-direction[:, 1], -1.0, 1.0))
    rise = 0.2 * np.maximum(elevation - np.radians(30.0), 0.0) + np.radians(8.0) * (
        2 * u[:, 11] - 1
    )
    forwards = np.radians(15.0) * direction[:, 2] + np.radians(8.0) * (2 * u[:, 12] - 1)
    vector = np.stack([0.0 * rise, -forwards, rise], axis=-1)
    collar = rotations.exp(vector)
    return (
        collar,
        rotations.canonical(rotations.multiply(rotations.inverse(collar), upper)),
        (rotations.canonical(lower)),
    )


def _blend(q_xyzw: Floats, weights: Floats) -> Floats:
    """Weighted linear blend (N,4) of rotations (N,K,4), brought to the first one's hemisphere."""
    sign = np.where(np.einsum("nki,ni->nk", q_xyzw, q_xyzw[:, 0]) < 0.0, -1.0, 1.0)
    return rotations.canonical(np.einsum("nki,nk->ni", q_xyzw, sign * weights))


def _beyond_limits(local_xyzw: Floats, slack_rad: float) -> NDArray[np.bool_]:
    """Whether a joint is bent farther than an adult's goes: (N,)."""
    limits = upper_body().limits
    out = np.zeros(len(local_xyzw), dtype=bool)
    for g in np.flatnonzero(limits.axis >= 0):
        j = limits.joint[g]
        angles = swing_twist(local_xyzw[:, j], int(limits.axis[g])) / limits.share[j]
        out |= (angles < limits.lower_rad[g] - slack_rad).any(axis=1)
        out |= (angles > limits.upper_rad[g] + slack_rad).any(axis=1)
    return out


def _cuts_trunk(local_xyzw: Floats) -> NDArray[np.bool_]:
    """Whether a forearm lies in the trunk or the head: (N,). Lengths in statures, frame of the chest."""
    out = np.zeros(len(local_xyzw), dtype=bool)
    for side, x in (("left", 1.0), ("right", -1.0)):
        collar, upper, lower = (
            local_xyzw[:, INDEX[side + bone]] for bone in ("Shoulder", "UpperArm", "LowerArm")
        )
        q = rotations.multiply(collar, upper)
        root = x * np.array([0.036, 0.0, 0.0]) + np.array([0.0, -0.02, 0.02])
        shoulder = root + rotations.rotate(collar, np.array([x * 0.067, -0.037, 0.0]))
        along = np.array([x, 0.0, 0.0])
        elbow = shoulder + 0.146 * rotations.rotate(q, along)
        fore = rotations.rotate(rotations.multiply(q, lower), along)
        for t, radius in ((0.0, 0.01), (0.05, 0.015), (0.10, 0.015), (0.146, 0.012), (0.19, 0.012)):
            p = elbow + t * fore
            trunk = (p[:, 0] / (0.082 + radius)) ** 2 + ((p[:, 2] - 0.005) / (0.06 + radius)) ** 2
            out |= (trunk < 1.0) & (p[:, 1] < 0.0) & (p[:, 1] > -0.36)
            head = (p - np.array([0.0, 0.12, 0.03])) / (np.array([0.045, 0.07, 0.055]) + radius)
            out |= (head**2).sum(axis=1) < 1.0
    return out
