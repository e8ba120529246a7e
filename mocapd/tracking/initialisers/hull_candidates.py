"""Candidate people in the visual hull of three cameras or more.

A blob of one picture may hold a person, the light on the floor before and somebody behind. In space these come apart: what
stands above a place of the floor in the hull of all foregrounds is a candidate. Each camera's blob is the part of its
foreground that the candidate covers, with all below: legs in the colour of the lawn behind them are carved away. The carve is
the soft one of `vision/hull/ray_hull.py`, so that possible shadows count little, and nothing is carved where a background
is unknown.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from mocapd.geometry.camera_model import common_place, project, to_camera
from mocapd.tracking.cues.clothes.clothes_params import HullStartParams
from mocapd.tracking.initialisers.standing_initialiser import Blob, PersonCandidate, blob_within
from mocapd.types import Bytes, Camera, Floats, Singles
from mocapd.vision.foreground_kernels import BACKGROUND, BEFORE, UNKNOWN
from mocapd.vision.hull.ray_hull import box_about, carve_log_odds, views_of, voxel_centres


@dataclass(frozen=True, slots=True, eq=False)
class HullCandidate:
    """A possible person with the middle of the body at middle_m (3,)."""

    middle_m: Floats
    person: PersonCandidate


def hull_candidates(
    foregrounds: Mapping[int, Bytes],
    cameras: Sequence[Camera],
    image_scales: Sequence[int],
    params: HullStartParams,
) -> list[HullCandidate] | None:
    """The largest first; None with too few cameras for a hull.

    foregrounds (h,w): labels by camera index; cameras, image_scales: all, with the factors between frames and pictures.
    """
    p = params
    if len(foregrounds) < p.cameras:
        return None
    seeing = [cameras[i] for i in foregrounds]
    space_m = box_about(common_place(seeing), p.half_width_m, p.low_m, p.high_m)
    points_m, (nx, ny, nz) = voxel_centres(space_m, p.voxel_m)
    maps = [_log_odds(labels, p) for labels in foregrounds.values()]
    inside = carve_log_odds(seeing, maps, points_m) > 0.0
    views = views_of(seeing, points_m[inside])
    # who stands where one camera of three does not look is found as before two
    for least in (p.cameras, 2):
        hull = inside.copy()
        hull[inside] = views >= least
        found = _people(hull.reshape(nx, ny, nz), points_m, foregrounds, cameras, image_scales, p)
        if found:
            return found
    return []


def rehearse_hull(cameras: Sequence[Camera], params: HullStartParams) -> None:
    """Compiles or loads the hull's kernel. Nothing with too few cameras for a hull."""
    if len(cameras) >= params.cameras:
        carve_log_odds(cameras, [np.zeros((2, 2), np.float32) for _ in cameras], np.zeros((1, 3)))


def _people(
    columns: NDArray[np.bool_],
    points_m: Floats,
    foregrounds: Mapping[int, Bytes],
    cameras: Sequence[Camera],
    image_scales: Sequence[int],
    p: HullStartParams,
) -> list[HullCandidate]:
    """The candidates in a hull: of its voxels (X,Y,Z), Y upwards, those that belong to it."""
    # light on the floor makes a flat hull, which takes in no arm held out
    is_person = p.voxel_m * columns.sum(axis=1) >= p.least_high_m
    is_person |= columns[:, int((p.arms_m - p.low_m) / p.voxel_m) :].any(axis=1)
    n, numbered = cv2.connectedComponents(is_person.astype(np.uint8))
    parts = [columns & (numbered == k)[:, None] for k in range(1, n)]
    volumes_m3 = [p.voxel_m**3 * np.count_nonzero(part) for part in parts]
    largest = sorted(range(len(parts)), key=lambda k: -volumes_m3[k])
    right = [k for k in largest if p.least_m3 <= volumes_m3[k] <= p.most_m3]
    out = []
    for k in right[: p.people]:
        part_m = points_m[parts[k].reshape(-1)]
        above = np.maximum.accumulate(parts[k][:, ::-1], axis=1)[:, ::-1]
        above_m = points_m[above.reshape(-1)]
        blobs = {
            i: blob
            for i, labels in foregrounds.items()
            if (blob := _blob(labels, cameras[i], image_scales[i], above_m, p)) is not None
        }
        if len(blobs) > 1:
            middle_m = 0.5 * (part_m.min(axis=0) + part_m.max(axis=0))
            place_m = np.median(part_m, axis=0) * (1.0, 0.0, 1.0)
            out.append(HullCandidate(middle_m, PersonCandidate(place_m, blobs, 0.0)))
    return out


def _log_odds(labels: Bytes, p: HullStartParams) -> Singles:
    table = np.full(256, p.shadow, np.float32)
    table[[BACKGROUND, BEFORE, UNKNOWN]] = p.background, p.before, 0.0
    return np.asarray(table[labels], np.float32)


def _blob(
    labels: Bytes, camera: Camera, image_scale: int, part_m: Floats, p: HullStartParams
) -> Blob | None:
    """What of a camera's foreground (h,w) the voxels at part_m (P,3) cover, down to the floor."""
    h, w = labels.shape
    lowest_m = part_m[part_m[:, 1] < p.low_m + p.voxel_m]
    part_m = np.concatenate([part_m, lowest_m * (1.0, 0.0, 1.0) + (0.0, 0.5 * p.low_m, 0.0)])
    at = (project(camera, part_m) + 0.5) / image_scale - 0.5
    xy = np.rint(np.nan_to_num(at, nan=-1.0)).astype(np.int64)
    is_seen = ((xy >= 0) & (xy < (w, h))).all(axis=1)
    if not is_seen.any():
        return None
    covered = np.zeros((h, w), np.uint8)
    covered[xy[is_seen, 1], xy[is_seen, 0]] = 1
    away_m = float(np.median(to_camera(camera, part_m[is_seen])[:, 2]))
    side = 2 * int(np.ceil(p.voxel_m * camera.K[0, 0] / (image_scale * away_m))) + 1
    about = np.asarray(cv2.dilate(covered, np.ones((side, side), np.uint8)), np.uint8)
    return blob_within(labels, about)
