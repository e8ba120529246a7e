"""The world frame from a standing and walking person: gravity, floor and origin."""

from collections.abc import Sequence

import numpy as np

from mocapd.body.model import build_model, shape_of
from mocapd.body.shape import skeleton_of
from mocapd.body.skeleton import INDEX
from mocapd.calibrate.self_calibration.patch_tracks import MARKS, PatchObservation
from mocapd.errors import ConfigError
from mocapd.geometry.camera_model import camera_from_world, with_extrinsics
from mocapd.geometry.rigid_transforms import RigidTransform
from mocapd.geometry.triangulation import triangulate
from mocapd.types import Floats, Rig

_LEAN_RAD = 0.1  # a spine further from the usual direction is bent
_START = 15  # first observations, in which the person faces forwards
_NAMES = ("hips", "neck", "leftUpperArm", "rightUpperArm")
_PLACES = [int(np.flatnonzero(INDEX[name] == MARKS)[0]) for name in _NAMES]


def align_with_gravity(
    rig: Rig, observations: Sequence[PatchObservation], stature_m: float, factors: Floats
) -> Rig:
    """The rig in the world of a person who stood and walked in it.

    Up is the median direction of the spine, without observations of bending; the floor is at the feet of a body with
    these proportions (n_shape,) that stands straight; the origin is the person's first position, facing +Z. Raises
    ConfigError without an observation by two cameras.
    """
    body = _bodies(rig, observations)
    rest = skeleton_of(shape_of(build_model(stature_m), factors)).rest_m
    spine = body[:, 1] - body[:, 0]
    spine = spine / np.linalg.norm(spine, axis=1, keepdims=True)
    up = _unit(np.median(spine, axis=0))
    for _ in range(10):
        unbent = spine @ up > np.cos(_LEAN_RAD)
        if not unbent.any():
            break
        up = _unit(spine[unbent].mean(axis=0))
    hips = body[:, 0]
    # knees bend now and then; they never make a person taller
    height = float(np.percentile(hips @ up, 75))
    floor = height - rest[INDEX["hips"], 1]
    across = _unit(np.median(body[:_START, 2] - body[:_START, 3], axis=0))  # right to left is +X
    forwards = _unit(np.cross(across, up))
    start = np.median(hips[:_START], axis=0)
    R = np.stack([np.cross(up, forwards), up, forwards])
    origin = start + (floor - start @ up) * up
    scene_from_world = RigidTransform(R, -R @ origin).inverse()
    return Rig(
        tuple(with_extrinsics(c, camera_from_world(c) @ scene_from_world) for c in rig.cameras)
    )


def _bodies(rig: Rig, observations: Sequence[PatchObservation]) -> Floats:
    """Hips, neck and shoulders (F,4,3) of every observation by at least two cameras."""
    missing = np.full((len(_NAMES), 2), np.nan)
    xy = np.array(
        [
            [m[c.name].marks_xy[_PLACES] if c.name in m else missing for m in observations]
            for c in rig.cameras
        ]
    ).reshape(len(rig.cameras), -1, len(_NAMES), 2)
    points, _ = triangulate(rig.cameras, xy)
    good: Floats = points[np.isfinite(points).all(axis=(1, 2))]
    if len(good) == 0:
        raise ConfigError(
            "no two cameras saw the wearer at once", "room", "walk where both see the shirt"
        )
    return good


def _unit(v: Floats) -> Floats:
    return v / np.linalg.norm(v)
