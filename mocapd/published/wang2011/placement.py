"""Step 2: a pose from the database for each camera, then one place in the world from all patches."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mocapd.body.areas import N_AREAS
from mocapd.body.model import BodyModel
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import normalised
from mocapd.published.wang2011.drawing import (
    Grid,
    PatchRenderer,
    draw_vertices,
    posed_points,
    posture,
    project_body,
    triangle_points,
)
from mocapd.published.wang2011.segmenter import Sight
from mocapd.shirt.garment import shirt_labels
from mocapd.shirt.pose_database.database import PoseDatabase, camera_from_view
from mocapd.shirt.pose_database.idmap_crop_kernels import crop_window
from mocapd.shirt.pose_database.idmap_render_kernels import CANVAS
from mocapd.types import Camera, Floats, Ints
from mocapd.vision.raster_kernels import label_triangles

_VIEW_DISTANCE_M = 2.8
_MIN_SAMPLES = 8  # of a patch on the canvas
# Residuals beyond the scale are weighed down. It narrows step by step: a start is off by some tenths of
# a metre, at which a narrow scale would give up one camera for the other.
_SCALES_RAD = (0.5, 0.15, 0.05)
_ITERATIONS = 6  # for each scale


@dataclass(frozen=True, slots=True, eq=False)
class Guess:
    """Database matches of one camera's id map: the ten nearest poses and the root in the camera's frame."""

    camera: Camera
    indices: Ints
    distances: Floats
    camera_from_root_xyzw: Floats  # (4,), view direction taken into account
    view_from_root_xyzw: Floats  # (4,)
    root_in_camera_m: Floats  # (3,)


@dataclass(frozen=True, slots=True, eq=False)
class Constraints:
    """Patch centroids of one camera: points (K,3) of the body in the root's frame [m], their
    observations in normalised image coordinates (K,2), and weight (K,)."""

    camera: Camera
    points_m: Floats
    observed_xy: Floats
    weight: Floats


def guess(database: PoseDatabase, camera: Camera, sight: Sight, neighbours: int) -> Guess:
    """The nearest database poses of a camera's id map."""
    indices, distances = database.nearest(sight.map40, neighbours)
    _, view_from_root = database.blend(indices, distances)
    focal = float(np.sqrt(camera.K[0, 0] * camera.K[1, 1]))
    turn = camera_from_view(camera, sight.centre_px)
    side_rad = sight.map_scale * sight.map40.shape[0] / focal
    root = rotations.rotate(turn, database.root_in_view(indices, distances, side_rad))
    return Guess(
        camera, indices, distances, rotations.multiply(turn, view_from_root), view_from_root, root
    )


def blended_local(database: PoseDatabase, guesses: Sequence[Guess]) -> Floats:
    """Local rotations (J,4) blended over the neighbours of all cameras."""
    indices = np.concatenate([guess.indices for guess in guesses])
    distances = np.concatenate([guess.distances for guess in guesses])
    order = np.argsort(distances, kind="stable")  # the best one's hemisphere counts
    local, _ = database.blend(indices[order], distances[order])
    return local


def constraints(model: BodyModel, local_xyzw: Floats, guess: Guess, sight: Sight) -> Constraints:
    """Centroids of the patches of the blended pose's id map, carried over into the camera's image."""
    local = local_xyzw.copy()
    local[0] = rotations.IDENTITY_XYZW
    points = posed_points(model, posture(model, np.zeros(3), local), triangle_points(model))
    drawing, window = _as_database_draws(model, local, guess.view_from_root_xyzw)
    patches = [p for p in range(1, N_AREAS) if drawing.count[p] >= _MIN_SAMPLES]
    cx, cy, side = window
    cells = (drawing.centroid[patches] - [cx, cy]) / max(side, 1.0)
    pixels = sight.centre_px + cells * sight.map_scale * sight.map40.shape[0]
    means = np.array(
        [np.average(points[model.area == p], axis=0, weights=drawing.samples[model.area == p])
         for p in patches]
    ).reshape(-1, 3)  # fmt: skip
    # the map with nearer database poses has the better patches
    weight = np.sqrt(drawing.count[patches]) / (1.0 + float(guess.distances.mean()))
    return Constraints(guess.camera, means, normalised(guess.camera, pixels), weight)


def _as_database_draws(
    model: BodyModel, local_xyzw: Floats, view_from_root: Floats
) -> tuple[PatchRenderer, tuple[float, float, float]]:
    """The pose on the database's canvas, and the crop's window on it (centre x, y and side)."""
    local = local_xyzw.copy()
    local[0] = view_from_root
    body = posture(model, np.zeros(3), local)
    t = -0.5 * (body.joints_m[0] + body.joints_m[3]) + np.array([0.0, 0.0, _VIEW_DISTANCE_M])
    view = Camera("view", (1, 1), np.diag([650.0, 650.0, 1.0]), np.zeros(5), np.eye(3), t)
    xy, depth = project_body(model, body, view, Grid(0, 0, 1, 1, 1))
    colour = shirt_labels(model).label
    shirt = np.unique(model.triangles[colour > 0])
    low, high = xy[shirt].min(axis=0), xy[shirt].max(axis=0)
    scale = (CANVAS - 2) / max(float((high - low).max()), 1.0)
    xy = (xy - 0.5 * (low + high)) * scale + 0.5 * (CANVAS - 1)
    drawing = draw_vertices(model, xy, depth, CANVAS, CANVAS)
    ids = np.empty((CANVAS, CANVAS), np.uint8)
    label_triangles(drawing.triangle_at, colour, ids)
    return drawing, crop_window(ids)


def place(starts: Sequence[Guess], centroids: Sequence[Constraints]) -> tuple[Floats, Floats]:
    """World position (3,) and rotation (4,) of the root that fit the centroids of all cameras best.

    Levenberg-Marquardt over 6 degrees of freedom from each camera's own guess; the best end wins.
    """
    best: tuple[float, Floats, Floats] | None = None
    for start in starts:
        R, t = start.camera.R, start.camera.t_m
        world_from_camera = rotations.from_matrix(R.T)
        q = rotations.multiply(world_from_camera, start.camera_from_root_xyzw)
        end = _refine(centroids, R.T @ (start.root_in_camera_m - t), rotations.canonical(q))
        if best is None or end[0] < best[0]:
            best = end
    assert best is not None
    return best[1], best[2]


def _refine(
    centroids: Sequence[Constraints], root: Floats, q: Floats
) -> tuple[float, Floats, Floats]:
    for scale_rad in _SCALES_RAD:
        root, q = _descend(centroids, root, q, scale_rad)
    return _normal_equations(centroids, root, q, _SCALES_RAD[1])[0], root, q


def _descend(
    centroids: Sequence[Constraints], root: Floats, q: Floats, scale_rad: float
) -> tuple[Floats, Floats]:
    damping = 1e-3
    cost, gradient, hessian = _normal_equations(centroids, root, q, scale_rad)
    for _ in range(_ITERATIONS):
        step = -np.linalg.solve(hessian + damping * np.diag(np.diag(hessian) + 1e-9), gradient)
        new_root = root + step[:3]
        new_q = rotations.canonical(
            rotations.multiply(rotations.exp(np.asarray(step[3:], dtype=np.float64)), q)
        )
        new = _normal_equations(centroids, new_root, new_q, scale_rad)
        if new[0] < cost:
            root, q, damping = new_root, new_q, damping * 0.3
            cost, gradient, hessian = new
        else:
            damping *= 10.0
    return root, q


def _normal_equations(
    centroids: Sequence[Constraints], root: Floats, q: Floats, scale_rad: float
) -> tuple[float, Floats, Floats]:
    cost, gradient, hessian = 0.0, np.zeros(6), np.zeros((6, 6))
    for c in centroids:
        arm = rotations.rotate(q[None], c.points_m)
        p = (root + arm) @ c.camera.R.T + c.camera.t_m
        z = np.maximum(p[:, 2:], 0.1)
        xy = p[:, :2] / z
        residual = xy - c.observed_xy
        # d xy / d p, then d p / d (root, turn about the world's axes)
        d = np.zeros((len(p), 2, 3))
        d[:, 0, 0] = d[:, 1, 1] = 1.0 / z[:, 0]
        d[:, :, 2] = -xy / z
        d = d @ c.camera.R
        J = np.concatenate([d, _cross(arm[:, None, :], d)], axis=2).reshape(-1, 6)
        size2 = (residual**2).sum(axis=1)
        # Geman-McClure: a wrong limb of one camera's guess must not turn the trunk
        w = c.weight / (1.0 + size2 / scale_rad**2) ** 2
        cost += float((c.weight * size2 / (1.0 + size2 / scale_rad**2)).sum())
        wide = np.repeat(w, 2)
        gradient += J.T @ (wide * residual.ravel())
        hessian += J.T @ (wide[:, None] * J)
    return cost, gradient, hessian


def _cross(a: Floats, b: Floats) -> Floats:
    """(n,2,3) of (n,1,3) and (n,2,3): what np.cross gives, in half the time for a few points."""
    out = np.empty_like(b)
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        out[..., i] = a[..., j] * b[..., k] - a[..., k] * b[..., j]
    return out
