"""Trains the covariances of the inverse kinematics on motion of our own, and writes calib/ik_covariances.json.

    python -m lab.training.train_covariances CACHE_DIR OUT.json [--sequences 60]

As in the paper, each term of the energy is evaluated at the true pose and its covariance taken over the
sequences: here smooth motions between poses of the database's generator, of bodies of various shapes
(the tracker assumes the mean one), seen by two cameras, their id maps damaged as a classifier damages
them.
"""

import argparse
import json
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np

from mocapd.body.model import BodyModel, build_model, shaped
from mocapd.body.posing_kernels import difference
from mocapd.body.shape import FACTOR_SD
from mocapd.geometry import rotations
from mocapd.published.wang2011.distance_maps import distance_maps
from mocapd.published.wang2011.drawing import (
    Grid,
    PatchRenderer,
    Posture,
    classified_patches,
    draw,
    posture,
    project_body,
)
from mocapd.published.wang2011.params import Params
from mocapd.published.wang2011.placement import blended_local, constraints, guess, place
from mocapd.published.wang2011.segmenter import Sight
from mocapd.shirt.garment import shirt_labels
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.shirt.pose_database.database_file import load_or_build
from mocapd.shirt.pose_database.idmap_crop_kernels import crop_id_map
from mocapd.shirt.pose_database.pose_sampling import SamplingParams, poses_from_cube, random_cube
from mocapd.types import Bytes, Camera, Floats
from mocapd.vision.raster_kernels import label_triangles

_FRAME_S = 1.0 / 30.0
_FRAMES = 24
_REACH = 60.0  # [samples] within which a classified sample finds its patch


@dataclass(slots=True)
class Errors:
    """What the terms of the energy are at the true pose."""

    centroid: list[Floats]
    blend: list[Floats]
    previous: list[Floats]


def cameras(rng: np.random.Generator) -> list[Camera]:
    """Two webcams at 2.3 to 3.3 m, knee height to above the head, 40 to 110 degrees apart."""
    first = rng.uniform(-1.0, 0.0)
    out = []
    for name, azimuth in (("a", first), ("b", first + np.radians(rng.uniform(40.0, 110.0)))):
        distance, height = rng.uniform(2.3, 3.3), rng.uniform(0.6, 2.2)
        centre = np.array([distance * np.sin(azimuth), height, distance * np.cos(azimuth)])
        z = np.array([0.0, 1.15, 0.0]) - centre
        z /= np.linalg.norm(z)
        x = np.cross(z, [0.0, 1.0, 0.0])
        x /= np.linalg.norm(x)
        R = np.stack([x, np.cross(z, x), z])
        K = np.array([[650.0, 0.0, 319.5], [0.0, 650.0, 239.5], [0.0, 0.0, 1.0]])
        out.append(Camera(name, (640, 480), K, np.zeros(5), R, -R @ centre))
    return out


def motion(rng: np.random.Generator, stature_m: float) -> list[tuple[Floats, Floats]]:
    """Roots (3,) and local rotations (J,4) of _FRAMES frames: smooth from one random pose to the next."""
    poses = poses_from_cube(random_cube(16, int(rng.integers(1 << 31))), SamplingParams())
    ends = poses.local_xyzw[:2].astype(float)
    for end in ends:
        lean = [rng.normal(0.0, 0.12), rng.uniform(-1.2, 1.2), rng.normal(0.0, 0.08)]
        end[0] = rotations.exp(np.array(lean))
    ends[1, 0] = rotations.slerp(ends[0, 0], ends[1, 0], 0.4)
    duration_s = rng.uniform(0.35, 1.2)
    place_m = np.array([0.0, 0.55 * stature_m, 0.0]) + rng.normal(0.0, 0.12, (2, 3))
    out = []
    for i in range(_FRAMES):
        u = min(i * _FRAME_S / duration_s, 1.0)
        s = u**3 * (10.0 - 15.0 * u + 6.0 * u * u)  # minimum jerk
        local = rotations.slerp(ends[0], ends[1], np.full(len(ends[0]), s))
        out.append((place_m[0] + s * (place_m[1] - place_m[0]), local))
    return out


def damaged(drawing: PatchRenderer, colour: Bytes, rng: np.random.Generator) -> Bytes:
    """The colour ids (h,w) as a classifier sees them: frayed borders, blind spots, wrong colours."""
    ids = np.empty(drawing.triangle_at.shape, np.uint8)
    label_triangles(drawing.triangle_at, colour, ids)
    cloud = cv2.GaussianBlur(rng.standard_normal(ids.shape).astype(np.float32), (0, 0), 5.0)
    ids[cloud > np.quantile(cloud, 0.85)] = 0
    ids[rng.random(ids.shape) < 0.08] = 0
    wrong = rng.random(ids.shape) < 0.005
    ids[wrong] = rng.integers(1, 11, int(wrong.sum()))
    return ids


def _region(model: BodyModel, body: Posture, camera: Camera, params: Params) -> Grid:
    """A square around the body like the one that the histogram search finds."""
    n = params.stride_px
    xy, _ = project_body(model, body, camera, Grid(0, 0, 1, 1, 1))
    low, high = xy.min(axis=0), xy.max(axis=0)
    middle, half = 0.5 * (low + high), 0.6 * float((high - low).max())
    x0, y0 = (int(v) for v in np.clip(middle - half, 0, [639, 479]))
    x1, y1 = (int(v) for v in np.clip(middle + half, 1, [640, 480]))
    return Grid(x0, y0, max((x1 - x0) // n, 1), max((y1 - y0) // n, 1), n)


def _sight(ids: Bytes, grid: Grid) -> Sight:
    map40, scale, centre = crop_id_map(ids)
    return Sight(
        ids, grid, float(grid.width * grid.stride), map40, scale * grid.stride, grid.to_pixels(np.array(centre)),
        np.ones((1, 1), np.uint8), 31,
    )  # fmt: skip


def _gap(model: BodyModel, a: Posture, b: Posture) -> Floats:
    out = np.empty(model.n_pose)
    difference(
        a.root_m,
        a.local_xyzw,
        b.root_m,
        b.local_xyzw,
        model.joint_of_group,
        model.share_of_joint,
        out,
    )
    return out


def observe(
    database: PoseDatabase,
    model: BodyModel,
    shape: tuple[Floats, Floats],
    true: tuple[Floats, Floats],
    pair: list[Camera],
    rng: np.random.Generator,
    errors: Errors,
) -> None:
    """One frame: the tracker's steps 2 to 4 up to the centroids, and how far each is from the truth."""
    params = Params()
    worn = replace(model, vertices_m=shape[0], rest_m=shape[1])
    body, assumed = posture(worn, *true), posture(model, *true)
    sights = {}
    for camera in pair:
        grid = _region(worn, body, camera, params)
        ids = damaged(draw(worn, body, camera, grid), shirt_labels(model).label, rng)
        if (ids > 0).sum() >= params.min_samples:
            sights[camera.name] = _sight(ids, grid)
    guesses = {
        camera.name: guess(database, camera, sights[camera.name], params.neighbours)
        for camera in pair
        if camera.name in sights
    }
    if not guesses:
        return
    local = blended_local(database, list(guesses.values()))
    marks = [constraints(model, local, g, sights[name]) for name, g in guesses.items()]
    root_m, local[0] = place(list(guesses.values()), marks)
    blended = posture(model, root_m, local)
    errors.blend.append(_gap(model, assumed, blended))
    for name, g in guesses.items():
        grid = sights[name].grid
        rendered = np.empty((grid.height, grid.width), np.uint8)
        drawing = draw(model, blended, g.camera, grid)
        label_triangles(drawing.triangle_at, shirt_labels(model).label, rendered)
        _, nearest_yx = distance_maps(rendered, _REACH)
        count, centroid = classified_patches(
            sights[name].ids, nearest_yx, drawing.triangle_at, model.area
        )
        truth = draw(model, assumed, g.camera, grid)
        both = (count >= params.min_patch_samples) & (truth.count >= params.min_patch_samples)
        both[0] = False
        errors.centroid.extend((truth.centroid - centroid)[both] * grid.stride)


def covariance(samples: list[Floats], floor: float) -> Floats:
    """Second moments about zero of samples (N,D), the worst 2 % left out, with a floor on the diagonal."""
    x = np.array(samples)
    size = ((x / x.std(axis=0).clip(1e-9)) ** 2).sum(axis=1)
    x = x[size <= np.quantile(size, 0.98)]
    moments: Floats = x.T @ x / len(x) + floor * np.eye(x.shape[1])
    return moments


def main() -> int:
    """Train and write."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("cache_dir", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--sequences", type=int, default=60)
    parser.add_argument("--seed", type=int, default=17)
    arguments = parser.parse_args()
    database = load_or_build(arguments.cache_dir).database
    errors = Errors([], [], [])
    for n in range(arguments.sequences):
        rng = np.random.default_rng((arguments.seed, n))
        stature_m = rng.uniform(1.55, 1.9)
        model = build_model(stature_m)
        shape = shaped(model, 1.0 + np.clip(rng.normal(0.0, FACTOR_SD), -0.3, 0.3))
        pair = cameras(rng)
        frames = motion(rng, stature_m)
        for i, true in enumerate(frames):
            if i > 0:
                now, before = posture(model, *true), posture(model, *frames[i - 1])
                errors.previous.append(_gap(model, now, before))
            if i % 4 == 0:  # neighbours in time say nearly the same
                observe(database, model, shape, true, pair, rng, errors)
        sys.stderr.write(f"\r{n + 1}/{arguments.sequences} sequences")
    sys.stderr.write("\n")
    matrices = {
        "centroid_px2": covariance(errors.centroid, 1.0),
        "blend": covariance(errors.blend, 1e-3),
        "previous": covariance(errors.previous, 1e-4),
    }
    about = (
        "Covariances of the inverse kinematics on patch centroids, trained on generated motion by "
        "lab.training.train_covariances: centroids [px^2 at 640x480], the database's "
        "blend and the previous frame of 1/30 s [m, rad; root, then rotation groups of body/model.py]"
    )
    rounded = {name: np.round(matrix, 7).tolist() for name, matrix in matrices.items()}
    arguments.out.write_text(json.dumps({"about": about, **rounded}) + "\n", encoding="utf-8")
    spread = np.sqrt(np.diag(matrices["blend"])).round(2)
    sys.stdout.write(
        f"{len(errors.blend)} poses, {len(errors.centroid)} centroids; standard deviations: centroid "
        f"{np.sqrt(np.diag(matrices['centroid_px2'])).round(1)} px, blend {spread}\n"
    )
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
