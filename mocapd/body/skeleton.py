"""The VRM humanoid skeleton: proportions, forward kinematics, local and global rotations."""

import json
from functools import cache

import numpy as np

from mocapd.assets import asset_path
from mocapd.body.bones import NAMES, PARENT_OF, other_side
from mocapd.geometry import rotations
from mocapd.types import Floats, Ints, Pose, Skeleton

INDEX = {name: i for i, name in enumerate(NAMES)}
PARENTS = np.array([INDEX[PARENT_OF[n]] if n in PARENT_OF else -1 for n in NAMES], dtype=np.int64)
N_JOINTS = len(NAMES)


# (J,) of a left joint the right one
OTHER_SIDE = np.array([INDEX[other_side(name)] for name in NAMES])


@cache
def mean_proportions() -> Floats:
    """T-pose joint centres (J,3) as fractions of stature, made symmetric about x = 0."""
    joints = json.loads(asset_path("body_proportions.json").read_text())["joints"]
    rest = np.array([joints[name]["mean"] for name in NAMES])
    symmetric: Floats = 0.5 * (rest + rest[OTHER_SIDE] * np.array([-1.0, 1.0, 1.0]))
    return symmetric


def standard_skeleton(stature_m: float) -> Skeleton:
    """The mean skeleton of a person of this stature."""
    return Skeleton(NAMES, PARENTS, mean_proportions() * stature_m)


def rest_pose(skeleton: Skeleton) -> Pose:
    """The T-pose with the feet on the floor at the origin."""
    return Pose(
        skeleton.rest_m[0].copy(), np.tile(rotations.IDENTITY_XYZW, (len(skeleton.names), 1))
    )


@cache
def _ancestry(parents: bytes) -> Floats:
    """(J,J): 1 where the column's joint is the row's joint or above it; the root's column is 0."""
    above = np.eye(len(parents) // 8)
    for j, parent in enumerate(np.frombuffer(parents, dtype=np.int64)[1:], start=1):
        above[j] += above[parent]
    above[:, 0] = 0.0
    return above


@cache
def _generations(parents: bytes) -> tuple[tuple[Ints, Ints], ...]:
    """Joints and their parents, by distance from the root: children, grandchildren, ..."""
    of = np.frombuffer(parents, dtype=np.int64)
    out, last = [], np.array([0])
    while len(last := np.flatnonzero(np.isin(of, last))):
        out.append((last, of[last]))
    return tuple(out)


def joint_positions(skeleton: Skeleton, pose: Pose) -> Floats:
    """Forward kinematics: joint centres (J,3) in the world [m]."""
    parents = skeleton.parents
    offsets = skeleton.rest_m - skeleton.rest_m[parents]
    turned = rotations.rotate(pose.quats_xyzw[parents], offsets)
    out: Floats = _ancestry(parents.tobytes()) @ turned
    out += pose.root_m
    return out


def local_from_global(skeleton: Skeleton, global_xyzw: Floats) -> Floats:
    """Rotations (...,J,4) relative to the parent bone from global ones."""
    above = global_xyzw[..., skeleton.parents, :]
    local = rotations.multiply(rotations.inverse(above), global_xyzw)
    local[..., 0, :] = global_xyzw[..., 0, :]
    return rotations.canonical(local)


def global_from_local(skeleton: Skeleton, local_xyzw: Floats) -> Floats:
    """Global rotations (J,4) from those relative to the parent bone."""
    out = np.array(local_xyzw, dtype=float)
    for joints, parents in _generations(skeleton.parents.tobytes()):
        out[joints] = rotations.multiply(out[parents], out[joints])
    return rotations.canonical(out)
