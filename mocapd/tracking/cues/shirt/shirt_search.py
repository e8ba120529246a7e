"""Finds the wearer without a previous pose: colour detection, pose database look-up, fit, check."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mocapd.fit.fit_result import Fit
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.view import View
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import centre, normalised, rays
from mocapd.geometry.triangulation import triangulate
from mocapd.shirt.pose_database.database import PoseDatabase, camera_from_view
from mocapd.shirt.pose_database.idmap_crop_kernels import SIZE, crop_id_map
from mocapd.shirt.segmentation.camera_segmenter import CameraSegmenter, ShirtCandidate
from mocapd.types import Camera, Floats

WINDOWS = np.array([8, 12, 17, 23, 30, 40])  # sides of find_shirt [cells of 4 work px]: six scales
_APART_M = 0.5  # rays to the two crops that miss each other by more mean two things
_SOMETHING = 0.06  # of what is drawn or seen: shirts explained 0.08 and more, mostly 0.4 to 0.7
_LOOSE_S = 0.4  # a hypothesis is held as loosely as a prediction over this time


@dataclass(frozen=True, slots=True, eq=False)
class ShirtSighting:
    """A shirt detection in one camera with its nearest poses of the database and their map distances."""

    index: int  # of the camera
    candidate: ShirtCandidate
    centre_px: Floats  # full resolution
    side_px: float
    poses: np.ndarray
    distances: Floats


def detect_shirt(
    index: int, segmenter: CameraSegmenter, database: PoseDatabase, neighbours: int
) -> ShirtSighting | None:
    """Detects the shirt in one camera's present picture; neighbours: number of poses to look up."""
    candidate = segmenter.find(WINDOWS)
    if candidate is None:
        return None
    id_map, scale, (cx, cy) = crop_id_map(candidate.ids)
    poses, distances = database.nearest(id_map, neighbours)
    if len(poses) == 0:
        return None
    work = np.array([cx + candidate.roi[0], cy + candidate.roi[1]])
    return ShirtSighting(
        index,
        candidate,
        (work + 0.5) * segmenter.image_scale - 0.5,
        scale * SIZE * segmenter.image_scale,
        poses,
        distances,
    )


def hypotheses(
    sightings: Sequence[ShirtSighting],
    cameras: Sequence[Camera],
    database: PoseDatabase,
    factors: Floats,
    information: Floats,
    n_pose: int,
) -> list[MotionState]:
    """A state per neighbour of every sighting, placed by triangulation where two cameras agree.

    n_pose: how many numbers a pose of the body has.
    """
    place: Floats | None = None
    if len(sightings) > 1:
        sighting_cameras = [cameras[s.index] for s in sightings]
        xy = np.array(
            [normalised(c, s.centre_px) for c, s in zip(sighting_cameras, sightings, strict=True)]
        )
        point, residual_m = triangulate(sighting_cameras, xy)
        if np.isfinite(point).all() and np.max(residual_m) < _APART_M:
            place = point
    out = []
    for s in sightings:
        camera = cameras[s.index]
        view = camera_from_view(camera, s.centre_px)
        world_from_camera_xyzw = rotations.from_matrix(camera.R.T)
        for i in range(len(s.poses)):
            pose, distance = s.poses[i : i + 1], s.distances[i : i + 1]
            side_rad = s.side_px / camera.K[0, 0]
            in_view = database.root_in_view(pose, distance, side_rad)
            if place is not None:
                _, ray = rays(camera, s.centre_px)
                depth = float((place - centre(camera)) @ ray)
                in_view = np.array([in_view[0], in_view[1], 0.0]) * depth / max(in_view[2], 0.1)
                in_view[2] = depth
            root = camera.R.T @ (rotations.rotate(view, in_view) - camera.t_m)
            local = database.local_xyzw[pose[0]].astype(float)
            turned = rotations.multiply(view, database.camera_from_root_xyzw[pose[0]].astype(float))
            local[0] = rotations.canonical(rotations.multiply(world_from_camera_xyzw, turned))
            out.append(MotionState(root, local, np.zeros(n_pose), factors, information))
    return out


def best_fit(fitter: Fitter, states: Sequence[MotionState], views: Sequence[View]) -> Fit | None:
    """Fit all hypotheses a little, the best three that explain something more; the one of least cost, None without any."""
    first = [fitter.fit(s, views, _LOOSE_S, 2, fine=1) for s in states]
    first = sorted((f for f in first if f.explained > _SOMETHING), key=lambda fit: fit.cost)
    more = [fitter.fit(f.state, views, _LOOSE_S, 4) for f in first[:3]]
    return min(more, key=lambda fit: fit.cost, default=None)
