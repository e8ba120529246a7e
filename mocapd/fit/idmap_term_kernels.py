"""Align the rendered body with the classified picture: the id-map distance of [WP09], minimised.

Each rendered pixel wants the nearest picture pixel of its colour, each classified pixel the nearest
rendered pixel of its colour: the two directions of the distance by which [WP09] compares id maps.
Each pixel that disagrees gives one row: the way to go (a direction in the picture, and how far) and
its derivative by pose and body shape, through the surface point seen there.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mocapd.body.posing_kernels import surface_row_of_arrays
from mocapd.fit.row_products_kernels import add_products
from mocapd.types import Bytes
from mocapd.vision.raster_kernels import triangle_middle

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


class Search(NamedTuple):
    """Where colours are looked for: offsets (N,2) within radius_px [work px] on a grid of grid_px;
    robust_px: where a residual has lost half of its weight. `every` 1: at all pixels of the grid; 2:
    at one colour of its checkerboard, given by `phase`. edge_weight: weight of edges in place."""

    offsets: NDArray[np.int32]
    radius_px: float
    robust_px: float
    grid_px: float
    every: int
    phase: int
    edge_weight: float


class ComparedPictures(NamedTuple):
    """The body as drawn (ids, and the triangle at each pixel) and the picture as classified: ids, and
    pixel_weight 0..255, the weight of a rendered pixel over an unclassified one (255 for sure background,
    less where something may hide the shirt). All (h,w), on the grid of the search."""

    model_ids: Bytes
    triangle_at: NDArray[np.int32]
    image_ids: Bytes
    pixel_weight: Bytes


class AlignmentSums(NamedTuple):
    """H (P,P), b (P,); visible, matched (21,): rendered pixels and those whose colour the picture has
    there, per patch; unexplained (21,): per patch, picture pixels drawn to it; in units of two work px."""

    H: Array
    b: Array
    visible: Array
    matched: Array
    unexplained: Array


def offsets_by_distance(radius_px: int) -> NDArray[np.int32]:
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


@njit(cache=True, nogil=True)
def _nearest_hidden(
    x: int,
    y: int,
    reach: float,
    xy: Array,
    triangles: NDArray[np.int32],
    sleeves: Ints,
    sleeve_start: Ints,
    k: int,
) -> int:
    """Place in `sleeves` of the triangle of colour k whose middle is nearest, seen or not; or -1."""
    best, found = reach * reach, -1
    for s in range(sleeve_start[k], sleeve_start[k + 1]):
        t = sleeves[s]
        middle_x, middle_y = triangle_middle(xy, triangles, t)
        r2 = (x - middle_x) ** 2 + (y - middle_y) ** 2
        if r2 < best:
            best, found = r2, s
    return found


_BLOCK = 128  # rows that are multiplied at a time
_CELL = 8  # px of the grid that tells which colours are within reach


@njit(cache=True, nogil=True)
def colours_in_reach(ids: NDArray[np.uint8], radius: float) -> NDArray[np.int32]:
    """Bit k of a cell of _CELL px is set where colour k may be within `radius` [px] of the cell: spares
    the search where it must fail. Bit 0 tells nothing."""
    h, w = ids.shape
    gh, gw = h // _CELL + 1, w // _CELL + 1
    own = np.zeros((gh, gw), np.int32)
    flat = ids.ravel()
    side = np.uint64(_CELL)
    for y in range(h):
        cells = own[y // _CELL]
        row = np.uint64(y * w)
        for gx in range(np.uint64(w // _CELL)):
            # most hold nothing; of unsigned places, which need no check, all eight are loaded at once
            first = row + gx * side
            some = np.uint8(0)
            for i in range(side):
                some |= flat[first + i]
            if some == 0:
                continue
            bits = np.int32(0)
            for i in range(side):
                bits |= np.int32(1) << flat[first + i]
            cells[gx] |= bits
        for x in range(w // _CELL * _CELL, w):
            cells[gw - 1] |= np.int32(1) << ids[y, x]
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
    pixel_weight: NDArray[np.uint8],
    offsets: NDArray[np.int32],
    n_offsets: int,
    grid_px: float,
    radius_px: float,
    robust_px: float,
    phase: int,
    every: int,
    edge_weight: float,
    xy: Array,
    triangles: NDArray[np.int32],
    sleeves: Ints,
    sleeve_start: Ints,
    patch: NDArray[np.uint8],
    centres: Array,
    d_centres: Array,
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
    """Add this camera's rows to H (P,P) and b (P,); return the summed robust cost.

    So many plain arguments on purpose: taken as named tuples, the compiler sums in another order, and
    what differs in the last digit is centimetres a second later, where an arm is hidden.
    The four pictures (h,w) are grids of `grid_px` work px; lengths, fx and fy are in work px.
    pixel_weight: weight of a rendered pixel over an unclassified picture pixel, 0..255 (255 for sure
    background, less where something may hide the shirt). visible, matched (21,): rendered pixels
    and those whose colour the picture has there, per patch; unexplained (21,): per patch, picture
    pixels drawn to it; all in units of two work px. `every` 1: all pixels of the grid are looked
    at; 2: one colour of its checkerboard, given by `phase`. offsets[:n_offsets] are those within
    radius_px.
    """
    h, w = model_ids.shape
    P = H.shape[0]
    row = np.empty(P)
    rows = np.empty((_BLOCK, P + 1))
    n_rows = 0
    square = np.zeros((P + 1, P + 1))
    g = np.empty(3)
    cost = 0.0
    r2_robust = robust_px * robust_px
    counted = 0.5 * every * grid_px * grid_px
    weight *= counted
    reach = radius_px / grid_px
    near_image = colours_in_reach(image_ids, reach)
    near_model = colours_in_reach(model_ids, reach)
    for y in range(h):
        for x in range((y + phase) % every, w, every):
            k_model = model_ids[y, x]
            k_image = image_ids[y, x]
            if k_model > 0:
                visible[patch[triangle_at[y, x]]] += counted
            if k_model == k_image:
                if k_model > 0:
                    matched[patch[triangle_at[y, x]]] += counted
                # an edge that is in place holds the body there: without it the few pixels that
                # disagree by less than their width would move it by all of that width
                if edge_weight == 0.0 or k_model == 0 or (x + y) // 2 & 1:  # half of them will do
                    continue
                if x == 0 or y == 0 or x == w - 1 or y == h - 1:
                    continue
                ex = int(model_ids[y, x + 1] != k_model) - int(model_ids[y, x - 1] != k_model)
                ey = int(model_ids[y + 1, x] != k_model) - int(model_ids[y - 1, x] != k_model)
                if ex == 0 and ey == 0:
                    continue
            for direction in range(2):
                if k_model == k_image:
                    if direction == 1:
                        continue
                    dx, dy = float(ex), float(ey)
                    t, row_weight = triangle_at[y, x], 2.0 * edge_weight * weight
                elif direction == 0:
                    if k_model == 0:
                        continue
                    i = -1
                    if near_image[y // _CELL, x // _CELL] >> k_model & 1:
                        i = _nearest(image_ids, x, y, k_model, offsets, n_offsets)
                    row_weight = weight
                    if k_image == 0:
                        row_weight *= pixel_weight[y, x] / 255.0
                    if i < 0:
                        cost += row_weight * r2_robust
                        continue
                    dx, dy = float(offsets[i, 0]), float(offsets[i, 1])
                    t = triangle_at[y, x]
                else:
                    if k_image == 0:
                        continue
                    i = -1
                    if near_model[y // _CELL, x // _CELL] >> k_image & 1:
                        i = _nearest(model_ids, x, y, k_image, offsets, n_offsets)
                    if i >= 0:
                        dx, dy = -float(offsets[i, 0]), -float(offsets[i, 1])
                        t = triangle_at[y + offsets[i, 1], x + offsets[i, 0]]
                    else:
                        s = _nearest_hidden(
                            x, y, reach, xy, triangles, sleeves, sleeve_start, k_image
                        )
                        if s < 0:
                            cost += weight * r2_robust
                            continue
                        t = sleeves[s]
                        middle_x, middle_y = triangle_middle(xy, triangles, t)
                        dx, dy = x - middle_x, y - middle_y
                    row_weight = weight
                    unexplained[patch[t]] += counted
                length = max(np.sqrt(dx * dx + dy * dy), 1e-3)
                r = grid_px * length
                r2 = r * r
                # Geman-McClure
                f = r2_robust / (r2_robust + r2)
                if k_model == k_image:
                    r = 0.0
                else:
                    cost += row_weight * r2 * f
                    row_weight *= f * f
                nx, ny = dx / length, dy / length
                point = centres[t]
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
                surface_row_of_arrays(
                    point,
                    triangle_bones[t],
                    triangle_weights[t],
                    d_centres[:, t],
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
                scale = np.sqrt(row_weight)
                for p in range(P):
                    rows[n_rows, p] = scale * row[p]
                rows[n_rows, P] = scale * r
                n_rows += 1
                if n_rows == _BLOCK:
                    add_products(rows, square)
                    n_rows = 0
    add_products(rows[:n_rows], square)
    H += square[:P, :P]
    b += square[:P, P]
    return cost
