"""Align the rendered body with the classified picture: the id-map distance of [WP09], minimised.

Each rendered pixel wants the nearest picture pixel of its label, each classified pixel the nearest
rendered pixel of its label: the two directions of the distance by which [WP09] compares id maps.
Each pixel that disagrees gives one row: the way to go (a direction in the picture, and how far) and
its derivative by pose and body shape, through the surface point seen there.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mocapd.fit.terms.nearest_pixel_kernels import CELL, labels_in_reach, nearest, nearest_hidden
from mocapd.fit.terms.row_products_kernels import add_products
from mocapd.types import Bytes
from mocapd.vision.raster_kernels import triangle_middle

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


class Search(NamedTuple):
    """Where labels are looked for: offsets (N,2) within radius_px [work px] on a grid of grid_px;
    robust_px: where a residual has lost half of its weight. `every` 1: at all pixels of the grid; 2:
    at every other one, as on a checkerboard, given by `phase`. edge_weight: weight of edges in place."""

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
    less where something may hide the body). All (h,w), on the grid of the search."""

    model_ids: Bytes
    triangle_at: NDArray[np.int32]
    image_ids: Bytes
    pixel_weight: Bytes


class AlignmentSums(NamedTuple):
    """H (P,P), b (P,); visible, matched (A,): rendered pixels and those whose label the picture has
    there, by area; unexplained (A,): by area, picture pixels drawn to it; in units of two work px."""

    H: Array
    b: Array
    visible: Array
    matched: Array
    unexplained: Array


_BLOCK = 128  # rows that are multiplied at a time


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
    arms: Ints,
    arms_start: Ints,
    area: NDArray[np.uint8],
    centres: Array,
    d_centres: Array,
    triangle_bones: NDArray[np.int32],
    triangle_weights: Array,
    rest: Array,
    d_rest: Array,
    parents: Ints,
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
    background, less where something may hide the body). visible, matched (A,): rendered pixels
    and those whose label the picture has there, by area; unexplained (A,): by area, picture
    pixels drawn to it; all in units of two work px. `every` 1: all pixels of the grid are looked
    at; 2: every other one, as on a checkerboard, given by `phase`. offsets[:n_offsets] are those within
    radius_px.
    """
    h, w = model_ids.shape
    P = H.shape[0]
    J = len(parents)
    moved = np.zeros(
        (J, 4)
    )  # by each joint: the sum of what the bones below it carry, and of their weights
    axes = np.empty((J, 3, 3))  # about which a joint's group turns, as columns
    for j in range(J):
        for i in range(3):
            for c in range(3):
                axes[j, i, c] = R[parents[j], i, c] if parents[j] >= 0 else (1.0 if i == c else 0.0)
    rows = np.empty((_BLOCK, P + 1))
    n_rows = 0
    square = np.zeros((P + 1, P + 1))
    cost = 0.0
    r2_robust = robust_px * robust_px
    counted = 0.5 * every * grid_px * grid_px
    weight *= counted
    reach = radius_px / grid_px
    near_image = labels_in_reach(image_ids, reach)
    near_model = labels_in_reach(model_ids, reach)
    for y in range(h):
        for x in range((y + phase) % every, w, every):
            k_model = model_ids[y, x]
            k_image = image_ids[y, x]
            if k_model > 0:
                visible[area[triangle_at[y, x]]] += counted
            if k_model == k_image:
                if k_model > 0:
                    matched[area[triangle_at[y, x]]] += counted
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
                    if near_image[y // CELL, x // CELL] >> k_model & 1:
                        i = nearest(image_ids, x, y, k_model, offsets, n_offsets)
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
                    if near_model[y // CELL, x // CELL] >> k_image & 1:
                        i = nearest(model_ids, x, y, k_image, offsets, n_offsets)
                    if i >= 0:
                        dx, dy = -float(offsets[i, 0]), -float(offsets[i, 1])
                        t = triangle_at[y + offsets[i, 1], x + offsets[i, 0]]
                    else:
                        s = nearest_hidden(x, y, reach, xy, triangles, arms, arms_start, k_image)
                        if s < 0:
                            cost += weight * r2_robust
                            continue
                        t = arms[s]
                        middle_x, middle_y = triangle_middle(xy, triangles, t)
                        dx, dy = x - middle_x, y - middle_y
                    row_weight = weight
                    unexplained[area[t]] += counted
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
                point, scale = centres[t], np.sqrt(row_weight)
                X = Y = Z = 0.0
                for bb in range(triangle_bones.shape[1]):
                    wt = triangle_weights[t, bb]
                    if wt == 0.0:
                        continue
                    j = triangle_bones[t, bb]
                    qx, qy, qz = point[0] - rest[j, 0], point[1] - rest[j, 1], point[2] - rest[j, 2]
                    px = wt * (R[j, 0, 0] * qx + R[j, 0, 1] * qy + R[j, 0, 2] * qz + joints[j, 0])
                    py = wt * (R[j, 1, 0] * qx + R[j, 1, 1] * qy + R[j, 1, 2] * qz + joints[j, 1])
                    pz = wt * (R[j, 2, 0] * qx + R[j, 2, 1] * qy + R[j, 2, 2] * qz + joints[j, 2])
                    X += px
                    Y += py
                    Z += pz
                    while j >= 0:
                        moved[j, 0] += px
                        moved[j, 1] += py
                        moved[j, 2] += pz
                        moved[j, 3] += wt
                        j = parents[j]
                cx = cam_R[0, 0] * X + cam_R[0, 1] * Y + cam_R[0, 2] * Z + cam_t[0]
                cy = cam_R[1, 0] * X + cam_R[1, 1] * Y + cam_R[1, 2] * Z + cam_t[1]
                cz = cam_R[2, 0] * X + cam_R[2, 1] * Y + cam_R[2, 2] * Z + cam_t[2]
                ux = scale * nx * fx / cz
                uy = scale * ny * fy / cz
                uz = -(ux * cx + uy * cy) / cz
                gx = cam_R[0, 0] * ux + cam_R[1, 0] * uy + cam_R[2, 0] * uz
                gy = cam_R[0, 1] * ux + cam_R[1, 1] * uy + cam_R[2, 1] * uz
                gz = cam_R[0, 2] * ux + cam_R[1, 2] * uy + cam_R[2, 2] * uz
                for p in range(3, P):
                    rows[n_rows, p] = 0.0
                rows[n_rows, 0] = gx
                rows[n_rows, 1] = gy
                rows[n_rows, 2] = gz
                for j in range(J):
                    if moved[j, 3] == 0.0:
                        continue
                    group = group_of_joint[j]
                    if group >= 0:
                        f = share_of_joint[j]
                        wj = moved[j, 3]
                        rx = moved[j, 0] - wj * joints[j, 0]
                        ry = moved[j, 1] - wj * joints[j, 1]
                        rz = moved[j, 2] - wj * joints[j, 2]
                        # a . (r x g) summed over the group's axes a
                        mx = f * (ry * gz - rz * gy)
                        my = f * (rz * gx - rx * gz)
                        mz = f * (rx * gy - ry * gx)
                        k = 3 + 3 * group
                        rows[n_rows, k] += (
                            axes[j, 0, 0] * mx + axes[j, 1, 0] * my + axes[j, 2, 0] * mz
                        )
                        rows[n_rows, k + 1] += (
                            axes[j, 0, 1] * mx + axes[j, 1, 1] * my + axes[j, 2, 1] * mz
                        )
                        rows[n_rows, k + 2] += (
                            axes[j, 0, 2] * mx + axes[j, 1, 2] * my + axes[j, 2, 2] * mz
                        )
                    moved[j, 0] = moved[j, 1] = moved[j, 2] = moved[j, 3] = 0.0
                if n_shape > 0:
                    for bb in range(triangle_bones.shape[1]):
                        wt, j = triangle_weights[t, bb], triangle_bones[t, bb]
                        # g in the bone's frame
                        hx = wt * (R[j, 0, 0] * gx + R[j, 1, 0] * gy + R[j, 2, 0] * gz)
                        hy = wt * (R[j, 0, 1] * gx + R[j, 1, 1] * gy + R[j, 2, 1] * gz)
                        hz = wt * (R[j, 0, 2] * gx + R[j, 1, 2] * gy + R[j, 2, 2] * gz)
                        for n in range(n_shape):
                            rows[n_rows, P - n_shape + n] += (
                                hx * (d_centres[n, t, 0] - d_rest[n, j, 0])
                                + hy * (d_centres[n, t, 1] - d_rest[n, j, 1])
                                + hz * (d_centres[n, t, 2] - d_rest[n, j, 2])
                                + wt * gx * d_joints[n, j, 0]
                                + wt * gy * d_joints[n, j, 1]
                                + wt * gz * d_joints[n, j, 2]
                            )
                rows[n_rows, P] = scale * r
                n_rows += 1
                if n_rows == _BLOCK:
                    add_products(rows, square)
                    n_rows = 0
    add_products(rows[:n_rows], square)
    H += square[:P, :P]
    b += square[:P, P]
    return cost
