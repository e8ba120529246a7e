"""Slow twin of the alignment kernel: plain loops, derivatives by differences."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.body.areas import N_AREAS
from mocapd.body.arrays import PosedJoints, camera_arrays, plain
from mocapd.body.model import BodyModel, shaped
from mocapd.body.posing_kernels import forward_kinematics, retract, skin_and_project
from mocapd.body.skeleton import N_JOINTS
from mocapd.fit.motion_state import MotionState
from mocapd.fit.surface_labels import SurfaceLabels
from mocapd.geometry import rotations
from mocapd.types import Bytes, Camera, Floats
from mocapd.vision.raster_kernels import label_triangles, rasterise

_STEP = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Posed:
    """A body drawn into a small picture (h,w), with what the kernel wants to know of its pose."""

    vertices: Floats
    joints: PosedJoints
    xy: Floats
    ids: Bytes
    triangle_at: NDArray[np.int32]


def posed(
    model: BodyModel, labels: SurfaceLabels, state: MotionState, camera: Camera, factor: int
) -> Posed:
    """The whole picture of a state, averaged down by `factor`."""
    vertices, rest = shaped(model, state.factors)
    R, joints, turned = np.zeros((N_JOINTS, 3, 3)), np.zeros((N_JOINTS, 3)), np.zeros((N_JOINTS, 4))
    forward_kinematics(model.parents, rest, state.root_m, state.local_xyzw, R, joints, turned)
    xy, depth = np.empty((len(vertices), 2)), np.empty(len(vertices))
    skin_and_project(
        vertices, plain(model.skin), plain(PosedJoints(rest, R, joints, turned)), plain(camera_arrays(camera)),
        np.zeros(2), 1.0 / factor, xy, depth,
    )  # fmt: skip
    h, w = camera.size_px[1] // factor, camera.size_px[0] // factor
    triangle_at, ids = np.empty((h, w), np.int32), np.empty((h, w), np.uint8)
    rasterise(xy, depth, model.triangles, np.empty((h, w), np.float32), triangle_at)
    label_triangles(triangle_at, labels.label, ids)
    return Posed(vertices, PosedJoints(rest, R, joints, turned), xy, ids, triangle_at)


@dataclass(slots=True, eq=False)
class Sums:
    """What the kernel adds up."""

    H: Floats
    b: Floats
    visible: Floats
    matched: Floats
    unexplained: Floats
    cost: float = 0.0

    @classmethod
    def zero(cls, size: int) -> "Sums":
        return cls(
            np.zeros((size, size)),
            np.zeros(size),
            np.zeros(N_AREAS),
            np.zeros(N_AREAS),
            np.zeros(N_AREAS),
        )


def accumulate(
    model: BodyModel,
    labels: SurfaceLabels,
    state: MotionState,
    drawn: Posed,
    camera: Camera,
    factor: int,
    image_ids: Bytes,
    pixel_weight: Bytes,
    grid_px: float,
    radius_px: float,
    robust_px: float,
    phase: int,
    every: int,
    edge_weight: float,
    n_shape: int,
    weight: float,
) -> Sums:
    """Rows of every disagreeing pixel, and of edges in place; `every` 2: of every other, as on a
    checkerboard. Lengths are in work px, of which a pixel of these pictures has `grid_px`."""
    size = model.n_pose + n_shape
    out = Sums.zero(size)
    slopes = grid_px * _slopes(model, state, camera, factor, size)
    units = every * grid_px**2 / 2.0
    weight *= units
    reach = radius_px / grid_px
    h, w = drawn.ids.shape
    for y in range(h):
        for x in range(w):
            if every == 2 and (x + y) % 2 != phase:
                continue
            want, have = drawn.ids[y, x], image_ids[y, x]
            if want:
                area = labels.area[drawn.triangle_at[y, x]]
                out.visible[area] += units
                out.matched[area] += units * (want == have)
            if want == have:
                edge = _edge(drawn.ids, x, y)
                if edge_weight and want and edge.any() and (x + y) // 2 % 2 == 0:
                    row = slopes[drawn.triangle_at[y, x]] @ (edge / np.hypot(*edge))
                    out.H += 2.0 * edge_weight * weight * np.outer(row, row)
                continue
            if want:
                strength = weight * (pixel_weight[y, x] / 255.0 if have == 0 else 1.0)
                to = _nearest(image_ids, x, y, want, reach)
                if to is None:
                    out.cost += strength * robust_px**2
                else:
                    away = grid_px * np.array([to[0] - x, to[1] - y], float)
                    _add(out, slopes[drawn.triangle_at[y, x]], away, strength, robust_px)
            if have:
                to = _nearest(drawn.ids, x, y, have, reach)
                t = _hidden(model, labels, drawn, x, y, have, reach) if to is None else None
                if to is not None:
                    t, place = drawn.triangle_at[to[1], to[0]], np.array(to, float)
                elif t is not None:
                    place = _middle(model, drawn, t)
                else:
                    out.cost += weight * robust_px**2
                    continue
                out.unexplained[labels.area[t]] += units
                _add(out, slopes[t], grid_px * (np.array([x, y]) - place), weight, robust_px)
    return out


def _edge(ids: Bytes, x: int, y: int) -> Floats:
    """Across a border of the id map, where both sides of it are in the picture."""
    h, w = ids.shape
    if not (0 < x < w - 1 and 0 < y < h - 1):
        return np.zeros(2)
    other = ids != ids[y, x]
    right, left = float(other[y, x + 1]), float(other[y, x - 1])
    below, above = float(other[y + 1, x]), float(other[y - 1, x])
    return np.array([right - left, below - above])


def _middle(model: BodyModel, drawn: Posed, t: int) -> Floats:
    middle: Floats = drawn.xy[model.triangles[t]].mean(axis=0)
    return middle


def _hidden(
    model: BodyModel, labels: SurfaceLabels, drawn: Posed, x: int, y: int, k: int, radius_px: float
) -> int | None:
    """The triangle of an arm of label k whose middle is nearest, though it may not be seen."""
    mine = [int(t) for t in labels.arms if labels.label[t] == k]
    apart = [np.hypot(*(_middle(model, drawn, t) - (x, y))) for t in mine]
    return mine[int(np.argmin(apart))] if mine and min(apart) < radius_px else None


def _add(out: Sums, slope: Floats, away: Floats, strength: float, robust_px: float) -> None:
    """One row: r px to go along a direction, by Geman and McClure's weights."""
    r = max(float(np.hypot(*away)), 1e-3)
    f = robust_px**2 / (robust_px**2 + r**2)
    row = slope @ (away / r)
    out.cost += strength * r**2 * f
    out.b += strength * f**2 * row * r
    out.H += strength * f**2 * np.outer(row, row)


def _nearest(ids: Bytes, x: int, y: int, k: int, radius_px: float) -> tuple[int, int] | None:
    """The nearest pixel of a label; of several, the upper, then the left one."""
    rows, columns = np.nonzero(ids == k)
    squared = (rows - y) ** 2 + (columns - x) ** 2
    near = squared <= radius_px**2
    if not near.any():
        return None
    best = np.lexsort((columns[near], rows[near], squared[near]))[0]
    return int(columns[near][best]), int(rows[near][best])


def _slopes(model: BodyModel, state: MotionState, camera: Camera, factor: int, size: int) -> Floats:
    """(T,size,2): how the centre of each triangle moves in the picture [work px], without distortion."""
    out = np.empty((len(model.triangles), size, 2))
    for k in range(size):
        ends = []
        for h in (-_STEP, _STEP):
            step = np.zeros(size)
            step[k] = h
            ends.append(_centres_px(model, state, camera, factor, step))
        out[:, k] = (ends[1] - ends[0]) / (2 * _STEP)
    return out


def _centres_px(
    model: BodyModel, state: MotionState, camera: Camera, factor: int, step: Floats
) -> Floats:
    root, local = np.empty(3), np.empty((N_JOINTS, 4))
    retract(
        state.root_m, state.local_xyzw, step[:model.n_pose],
        model.group_of_joint, model.share_of_joint, root, local,
    )  # fmt: skip
    factors = state.factors.copy()
    factors[: len(step) - model.n_pose] += step[model.n_pose :]
    vertices, rest = shaped(model, factors)
    R, joints, turned = np.zeros((N_JOINTS, 3, 3)), np.zeros((N_JOINTS, 3)), np.zeros((N_JOINTS, 4))
    forward_kinematics(model.parents, rest, root, local, R, joints, turned)
    centre = vertices[model.triangles].mean(axis=1)[:, None]
    bones = model.triangle_bones
    each = joints[bones] + rotations.rotate(turned[bones], centre - rest[bones])
    world = (model.triangle_weights[..., None] * each).sum(axis=1)
    seen = world @ camera.R.T + camera.t_m
    focal = np.array([camera.K[0, 0], camera.K[1, 1]]) / factor
    pixels: Floats = focal * seen[:, :2] / seen[:, 2:]
    return pixels
