"""Align the rendered body with the classified picture: the id-map distance of [WP09], minimised.

Each rendered pixel wants the nearest picture pixel of its colour, each classified pixel the nearest
rendered pixel of its colour: the two directions of the distance by which [WP09] compares id maps.
Each pixel that disagrees gives one row: the way to go (a direction in the picture, and how far) and
its derivative by pose and body shape, through the surface point seen there.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mocapd.body.posing_kernels import surface_row

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


def spiral(radius_px: int) -> NDArray[np.int32]:
    """Offsets (N,2) x, y within a radius, nearest first, without the centre."""
    r = np.arange(-radius_px, radius_px + 1)
    x, y = np.meshgrid(r, r)
    offsets = np.stack([x.ravel(), y.ravel()], axis=1)
    squared = (offsets**2).sum(axis=1)
    keep = (squared > 0) & (squared <= radius_px**2)
    order = np.lexsort((offsets[:, 0], offsets[:, 1], squared))
    inside: NDArray[np.int32] = offsets[order][keep[order]].astype(np.int32)
    return inside


@njit(cache=True, nogil=True, inline="always")
def _nearest(
    ids: NDArray[np.uint8],
    x: int,
    y: int,
    k: int,
    offsets: NDArray[np.int32],
    n_offsets: int,
) -> int:
    """Index of the nearest offset at which ids == k, or -1."""
    h, w = ids.shape
    for i in range(n_offsets):
        u = x + offsets[i, 0]
        v = y + offsets[i, 1]
        if 0 <= u < w and 0 <= v < h and ids[v, u] == k:
            return i
    return -1


# parameters of trunk, left arm, right arm, shape (body.model.GROUPS)
_SPANS = np.array([[0, 9], [9, 18], [18, 27], [27, 34]])
_CELL = 8  # px of the grid that tells which colours are within reach


@njit(cache=True, nogil=True)
def colours_in_reach(ids: NDArray[np.uint8], radius: float) -> NDArray[np.int32]:
    """Bit k of a cell of _CELL px is set where colour k may be within `radius` [px] of the cell: spares
    the search where it must fail."""
    h, w = ids.shape
    gh, gw = h // _CELL + 1, w // _CELL + 1
    own = np.zeros((gh, gw), np.int32)
    for y in range(h):
        for x in range(w):
            k = ids[y, x]
            if k > 0:
                own[y // _CELL, x // _CELL] |= np.int32(1) << k
    reach = int(np.ceil(radius / _CELL))
    rows = np.zeros((gh, gw), np.int32)
    for gy in range(gh):
        for gx in range(gw):
            for o in range(max(0, gx - reach), min(gw, gx + reach + 1)):
                rows[gy, gx] |= own[gy, o]
    out = np.zeros((gh, gw), np.int32)
    for gy in range(gh):
        for o in range(max(0, gy - reach), min(gh, gy + reach + 1)):
            for gx in range(gw):
                out[gy, gx] |= rows[o, gx]
    return out


@njit(cache=True, nogil=True, fastmath=True)
def accumulate(
    model_ids: NDArray[np.uint8],
    triangle_at: NDArray[np.int32],
    image_ids: NDArray[np.uint8],
    softness: NDArray[np.uint8],
    offsets: NDArray[np.int32],
    n_offsets: int,
    radius_px: float,
    robust_px: float,
    phase: int,
    row_step: int,
    triangles: NDArray[np.int32],
    patch: NDArray[np.uint8],
    vertices: Array,
    d_vertices: Array,
    triangle_bones: NDArray[np.int32],
    triangle_weights: Array,
    rest: Array,
    d_rest: Array,
    parents: Ints,
    joint_of_group: Ints,
    group_of_joint: Ints,
    share_of_joint: Array,
    R: Array,
    joints: Array,
    d_joints: Array,
    n_shape: int,
    cam_R: Array,
    cam_t: Array,
    fx: float,
    fy: float,
    weight: float,
    H: Array,
    b: Array,
    visible: Array,
    matched: Array,
    unexplained: Array,
) -> float:
    """Add this camera's rows to H (P,P) upper triangle and b (P,); return the summed robust cost.

    softness (h,w): weight of a rendered pixel over an unclassified picture pixel, 0..255 (255 for
    sure background, less where something may hide the shirt). fx, fy [work px]. visible, matched
    (21,): rendered pixels and those whose colour the picture has there, per patch; unexplained
    (21,): per patch, picture pixels drawn to it. Every second pixel of every `row_step`-th row is looked at, from
    `phase` 0 or 1 on; sums are scaled to all rows. offsets[:n_offsets] are those within radius_px.
    """
    h, w = model_ids.shape
    P = H.shape[0]
    row = np.empty(P)
    point = np.empty(3)
    d_point = np.empty((max(n_shape, 1), 3))
    g = np.empty(3)
    used = np.zeros(_SPANS.shape[0], np.bool_)
    cost = 0.0
    r2_robust = robust_px * robust_px
    weight *= row_step
    counted = float(row_step)
    near_image = colours_in_reach(image_ids, radius_px)
    near_model = colours_in_reach(model_ids, radius_px)
    for y in range(phase if row_step > 1 else 0, h, row_step):
        for x in range((y + phase) & 1, w, 2):
            k_model = model_ids[y, x]
            k_image = image_ids[y, x]
            if k_model > 0:
                visible[patch[triangle_at[y, x]]] += counted
            if k_model == k_image:
                if k_model > 0:
                    matched[patch[triangle_at[y, x]]] += counted
                continue
            for direction in range(2):
                if direction == 0:
                    if k_model == 0:
                        continue
                    i = -1
                    if near_image[y // _CELL, x // _CELL] >> k_model & 1:
                        i = _nearest(image_ids, x, y, k_model, offsets, n_offsets)
                    row_weight = weight
                    if k_image == 0:
                        row_weight *= softness[y, x] / 255.0
                    if i < 0:
                        cost += row_weight * r2_robust
                        continue
                    dx, dy = offsets[i, 0], offsets[i, 1]
                    t = triangle_at[y, x]
                else:
                    if k_image == 0:
                        continue
                    i = -1
                    if near_model[y // _CELL, x // _CELL] >> k_image & 1:
                        i = _nearest(model_ids, x, y, k_image, offsets, n_offsets)
                    if i < 0:
                        cost += weight * r2_robust
                        continue
                    dx, dy = -offsets[i, 0], -offsets[i, 1]
                    t = triangle_at[y - dy, x - dx]
                    row_weight = weight
                    unexplained[patch[t]] += counted
                r2 = float(dx * dx + dy * dy)
                r = np.sqrt(r2)
                # Geman-McClure
                f = r2_robust / (r2_robust + r2)
                cost += row_weight * r2 * f
                row_weight *= f * f
                nx, ny = dx / r, dy / r
                for c in range(3):
                    point[c] = (
                        vertices[triangles[t, 0], c]
                        + vertices[triangles[t, 1], c]
                        + vertices[triangles[t, 2], c]
                    ) / 3.0
                    for n in range(n_shape):
                        d_point[n, c] = (
                            d_vertices[n, triangles[t, 0], c]
                            + d_vertices[n, triangles[t, 1], c]
                            + d_vertices[n, triangles[t, 2], c]
                        ) / 3.0
                X = Y = Z = 0.0
                for bb in range(triangle_bones.shape[1]):
                    wt = triangle_weights[t, bb]
                    if wt == 0.0:
                        continue
                    j = triangle_bones[t, bb]
                    qx, qy, qz = point[0] - rest[j, 0], point[1] - rest[j, 1], point[2] - rest[j, 2]
                    X += wt * (R[j, 0, 0] * qx + R[j, 0, 1] * qy + R[j, 0, 2] * qz + joints[j, 0])
                    Y += wt * (R[j, 1, 0] * qx + R[j, 1, 1] * qy + R[j, 1, 2] * qz + joints[j, 1])
                    Z += wt * (R[j, 2, 0] * qx + R[j, 2, 1] * qy + R[j, 2, 2] * qz + joints[j, 2])
                cx = cam_R[0, 0] * X + cam_R[0, 1] * Y + cam_R[0, 2] * Z + cam_t[0]
                cy = cam_R[1, 0] * X + cam_R[1, 1] * Y + cam_R[1, 2] * Z + cam_t[1]
                cz = cam_R[2, 0] * X + cam_R[2, 1] * Y + cam_R[2, 2] * Z + cam_t[2]
                ux = nx * fx / cz
                uy = ny * fy / cz
                uz = -(ux * cx + uy * cy) / cz
                for c in range(3):
                    g[c] = cam_R[0, c] * ux + cam_R[1, c] * uy + cam_R[2, c] * uz
                surface_row(
                    point,
                    triangle_bones[t],
                    triangle_weights[t],
                    d_point,
                    g,
                    rest,
                    parents,
                    joint_of_group,
                    group_of_joint,
                    share_of_joint,
                    R,
                    joints,
                    d_rest,
                    d_joints,
                    n_shape,
                    row,
                )
                # most rows are empty but for the trunk, one arm and the shape: whole spans are skipped
                for i in range(_SPANS.shape[0]):
                    first, last = _SPANS[i, 0], min(_SPANS[i, 1], P)
                    empty = True
                    for p in range(first, last):
                        empty = empty and row[p] == 0.0
                    used[i] = not empty
                for i in range(_SPANS.shape[0]):
                    if not used[i]:
                        continue
                    for p in range(_SPANS[i, 0], min(_SPANS[i, 1], P)):
                        wp = row_weight * row[p]
                        b[p] += wp * r
                        for j in range(i, _SPANS.shape[0]):
                            if used[j]:
                                for q in range(max(p, _SPANS[j, 0]), min(_SPANS[j, 1], P)):
                                    H[p, q] += wp * row[q]
    return cost
