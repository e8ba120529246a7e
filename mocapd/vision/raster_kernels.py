"""Z-buffer rasteriser for id maps: which triangle is seen at each pixel of a small image region."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]

NOTHING = -1


@njit(cache=True, nogil=True, inline="always")
def triangle_middle(xy: Array, triangles: NDArray[np.int32], t: int) -> tuple[float, float]:
    """The mean of the vertices (V,2) of triangle t, where these are drawn [px]."""
    a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
    return (xy[a, 0] + xy[b, 0] + xy[c, 0]) / 3.0, (xy[a, 1] + xy[b, 1] + xy[c, 1]) / 3.0


@njit(cache=True, nogil=True)
def rasterise(
    xy: Array,
    depth: Array,
    triangles: NDArray[np.int32],
    zbuffer: NDArray[np.float32],
    triangle_at: NDArray[np.int32],
) -> None:
    """Fill triangle_at (h,w) with the nearest front-facing triangle, NOTHING elsewhere.

    xy (V,2) px in the buffer's own coordinates, pixel centres at integers; depth (V,) [m], only
    positive ones are drawn; triangles (T,3) counter-clockwise from outside (y down: clockwise on
    screen). zbuffer (h,w) is scratch.
    """
    h, w = triangle_at.shape
    for y in range(h):
        for x in range(w):
            zbuffer[y, x] = np.float32(1e9)
            triangle_at[y, x] = NOTHING
    draw(xy, depth, triangles, zbuffer, triangle_at)


@njit(cache=True, nogil=True)
def draw(
    xy: Array,
    depth: Array,
    triangles: NDArray[np.int32],
    zbuffer: NDArray[np.float32],
    triangle_at: NDArray[np.int32],
) -> None:
    """As `rasterise`, over what the buffers already hold."""
    h, w = triangle_at.shape
    for t in range(triangles.shape[0]):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        za, zb, zc = depth[a], depth[b], depth[c]
        if za <= 0.05 or zb <= 0.05 or zc <= 0.05:
            continue
        ax, ay = xy[a, 0], xy[a, 1]
        bx, by = xy[b, 0], xy[b, 1]
        cx, cy = xy[c, 0], xy[c, 1]
        # twice the signed area; outward normals towards the camera give a negative one (y down)
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if area >= 0.0:
            continue
        x0 = max(0, int(np.ceil(min(ax, min(bx, cx)))))
        x1 = min(w - 1, int(np.floor(max(ax, max(bx, cx)))))
        y0 = max(0, int(np.ceil(min(ay, min(by, cy)))))
        y1 = min(h - 1, int(np.floor(max(ay, max(by, cy)))))
        if x0 > x1 or y0 > y1:
            continue
        inverse = 1.0 / area
        # barycentric coordinates are affine in x and y
        ub_dx, ub_dy = -(ay - cy) * inverse, (ax - cx) * inverse
        uc_dx, uc_dy = (ay - by) * inverse, -(ax - bx) * inverse
        dz_b, dz_c = zb - za, zc - za
        for y in range(y0, y1 + 1):
            ub = ub_dx * (x0 - ax) + ub_dy * (y - ay)
            uc = uc_dx * (x0 - ax) + uc_dy * (y - ay)
            inside = False
            for x in range(x0, x1 + 1):
                if min(ub, min(uc, 1.0 - ub - uc)) >= -1e-9:
                    inside = True
                    z = np.float32(za + ub * dz_b + uc * dz_c)
                    if z < zbuffer[y, x]:
                        zbuffer[y, x] = z
                        triangle_at[y, x] = t
                elif inside:
                    break  # a triangle is convex
                ub += ub_dx
                uc += uc_dx


@njit(cache=True, nogil=True)
def label_triangles(
    triangle_at: NDArray[np.int32], label: NDArray[np.uint8], out: NDArray[np.uint8]
) -> None:
    """out (h,w) = label[triangle], 0 where nothing is seen."""
    h, w = triangle_at.shape
    for y in range(h):
        for x in range(w):
            t = triangle_at[y, x]
            out[y, x] = label[t] if t >= 0 else np.uint8(0)
