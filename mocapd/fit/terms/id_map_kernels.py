"""Align the rendered body with the classified picture: the id-map distance of [WP09], minimised.

Each rendered pixel wants the nearest picture pixel of its label, each classified pixel the nearest
rendered pixel of its label: the two directions of the distance by which [WP09] compares id maps.
Each pixel that disagrees gives one row: a direction in the picture and how far to go along it. The derivative of a row
by pose and shape goes through the centre of the triangle seen there, so the rows of a triangle are first summed in the
picture (`pull_triangles`), and each triangle gives two rows of the normal equations (`triangle_rows_kernels`).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapd.fit.terms.nearest_pixel_kernels import CELL, labels_in_reach, nearest, nearest_hidden
from mocapd.kernels.decorator import kernel
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


class LabelledTriangles(NamedTuple):
    """corners (T,3) of the triangles and the area (T,) of each; the triangles of arms with label k are
    arms[arms_start[k] : arms_start[k + 1]]."""

    corners: NDArray[np.int32]
    area: Bytes
    arms: Ints
    arms_start: Ints


class AreaCounts(NamedTuple):
    """Pixels (A,) by area, in units of two work px: those rendered, those of them whose label the picture has there, and
    picture pixels that are pulled to the area."""

    visible: Array
    matched: Array
    unexplained: Array


@kernel(fastmath=True)
def pull_triangles(
    pictures: ComparedPictures,
    search: Search,
    xy: Array,
    surface: LabelledTriangles,
    weight: float,
    counts: AreaCounts,
    pulls: Array,
) -> float:
    """Add to pulls (T,5) the rows of each triangle's pixels, to `counts` the pixels; return the summed robust cost.

    xy (V,2): the vertices as drawn [px of the grid]. A row of weight w, along the unit vector n in the picture, by r work px
    adds w nx nx, w nx ny, w ny ny, w r nx, w r ny. Weights are by Geman and McClure.
    """
    model_ids, triangle_at, image_ids, pixel_weight = pictures
    offsets, radius_px, robust_px, grid_px, every, phase, edge_weight = search
    corners, area, arms, arms_start = surface
    visible, matched, unexplained = counts
    h, w = model_ids.shape
    cost = 0.0
    n_offsets = offsets.shape[0]
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
                if k_model == 0:
                    continue
                matched[area[triangle_at[y, x]]] += counted
                # an edge that is in place holds the body there: without it the few pixels that
                # disagree by less than their width would move it by all of that width
                if edge_weight == 0.0 or (x + y) // 2 & 1:  # half of them will do
                    continue
                if x == 0 or y == 0 or x == w - 1 or y == h - 1:
                    continue
                ex = int(model_ids[y, x + 1] != k_model) - int(model_ids[y, x - 1] != k_model)
                ey = int(model_ids[y + 1, x] != k_model) - int(model_ids[y - 1, x] != k_model)
                if ex != 0 or ey != 0:
                    _pull(
                        pulls[triangle_at[y, x]],
                        float(ex),
                        float(ey),
                        2.0 * edge_weight * weight,
                        0.0,
                    )
                continue
            if k_model > 0:
                i = -1
                if near_image[y // CELL, x // CELL] >> k_model & 1:
                    i = nearest(image_ids, x, y, k_model, offsets, n_offsets)
                row_weight = weight
                if k_image == 0:
                    row_weight *= pixel_weight[y, x] / 255.0
                if i < 0:
                    cost += row_weight * r2_robust
                else:
                    cost += _pull_robustly(
                        pulls[triangle_at[y, x]], float(offsets[i, 0]), float(offsets[i, 1]), grid_px,
                        row_weight, r2_robust,
                    )  # fmt: skip
            if k_image > 0:
                i = -1
                if near_model[y // CELL, x // CELL] >> k_image & 1:
                    i = nearest(model_ids, x, y, k_image, offsets, n_offsets)
                if i >= 0:
                    dx, dy = -float(offsets[i, 0]), -float(offsets[i, 1])
                    t = triangle_at[y + offsets[i, 1], x + offsets[i, 0]]
                else:
                    s = nearest_hidden(x, y, reach, xy, corners, arms, arms_start, k_image)
                    if s < 0:
                        cost += weight * r2_robust
                        continue
                    t = arms[s]
                    middle_x, middle_y = triangle_middle(xy, corners, t)
                    dx, dy = x - middle_x, y - middle_y
                unexplained[area[t]] += counted
                cost += _pull_robustly(pulls[t], dx, dy, grid_px, weight, r2_robust)
    return cost


@kernel(fastmath=True, inline="always")
def _pull_robustly(
    pull: Array, dx: float, dy: float, grid_px: float, weight: float, r2_robust: float
) -> float:
    """Add a row of dx, dy [px of the grid] to `pull` (5,); its cost."""
    r: float = grid_px * max(np.sqrt(dx * dx + dy * dy), 1e-3)
    f = r2_robust / (r2_robust + r * r)
    _pull(pull, dx, dy, weight * f * f, r)
    return weight * r * r * f


@kernel(fastmath=True, inline="always")
def _pull(pull: Array, dx: float, dy: float, weight: float, r: float) -> None:
    """Add a row along dx, dy by r work px to `pull` (5,)."""
    inverse = 1.0 / max(np.sqrt(dx * dx + dy * dy), 1e-3)
    nx, ny = dx * inverse, dy * inverse
    pull[0] += weight * nx * nx
    pull[1] += weight * nx * ny
    pull[2] += weight * ny * ny
    pull[3] += weight * r * nx
    pull[4] += weight * r * ny
