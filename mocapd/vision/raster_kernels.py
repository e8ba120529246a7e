"""Z-buffer rasteriser for id maps: which triangle is seen at each pixel of a small image region."""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel

Array = NDArray[np.float64]

NOTHING = -1
_FAR = np.float32(1e9)  # [m]
_LANES = 4  # pixels that are drawn at once


@kernel(inline="always")
def triangle_middle(xy: Array, triangles: NDArray[np.int32], t: int) -> tuple[float, float]:
    """The mean of the vertices (V,2) of triangle t, where these are drawn [px]."""
    a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
    return (xy[a, 0] + xy[b, 0] + xy[c, 0]) / 3.0, (xy[a, 1] + xy[b, 1] + xy[c, 1]) / 3.0


@kernel
def bounds(xy: Array, depth: Array, least_m: float) -> tuple[int, float, float, float, float]:
    """How many of the vertices xy (V,2) [px] are farther away than least_m, by their depth (V,) [m], and the box of these:
    least x, least y, largest x, largest y."""
    n, x0, y0, x1, y1 = 0, np.inf, np.inf, -np.inf, -np.inf
    for v in range(xy.shape[0]):
        if depth[v] > least_m:
            n += 1
            x0, x1 = min(x0, xy[v, 0]), max(x1, xy[v, 0])
            y0, y1 = min(y0, xy[v, 1]), max(y1, xy[v, 1])
    return n, x0, y0, x1, y1


@kernel
def rasterise(
    xy: Array,
    depth: Array,
    triangles: NDArray[np.int32],
    depth_at: NDArray[np.float32],
    triangle_at: NDArray[np.int32],
) -> None:
    """Fill triangle_at (h,w) with the nearest front-facing triangle, NOTHING elsewhere, and depth_at (h,w) with its depth,
    _FAR elsewhere.

    xy (V,2) px in the buffer's own coordinates, pixel centres at integers; depth (V,) [m], only
    positive ones are drawn; triangles (T,3) counter-clockwise from outside (y down: clockwise on
    screen).
    """
    h, w = triangle_at.shape
    stride = w + _LANES  # the last step of a row may go on beyond it
    nearest = np.full(h * stride, _nearness(_FAR, NOTHING))
    shown, boxes = np.empty(len(triangles), np.int32), np.empty((len(triangles), 4), np.int32)
    for i in range(_list_shown(xy, depth, triangles, h, w, shown, boxes)):
        _draw(xy, depth, triangles, shown[i], boxes[i], stride, nearest)
    for y in range(h):
        row = np.uint64(y * stride)
        for x in range(w):
            there = nearest[row + np.uint64(x)]
            depth_at[y, x] = np.int32(there >> 32).view(np.float32)
            triangle_at[y, x] = np.int32(there)


@kernel(inline="always")
def _nearness(z: np.float32, t: int) -> np.int64:
    """Depth z >= 0 and triangle t as one number: the nearer, and of two at one place the first one, has the smaller."""
    return np.int64(np.float32(z).view(np.int32)) << 32 | np.int64(np.uint32(t))


@kernel
def _list_shown(
    xy: Array,
    depth: Array,
    triangles: NDArray[np.int32],
    h: int,
    w: int,
    shown: NDArray[np.int32],
    boxes: NDArray[np.int32],
) -> int:
    """How many triangles face a picture (h,w) and reach it: listed first in `shown` (T,), with boxes (T,4) of the first and
    last x and y [px]."""
    n = 0
    for t in range(triangles.shape[0]):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ax, ay = xy[a, 0], xy[a, 1]
        bx, by = xy[b, 0], xy[b, 1]
        cx, cy = xy[c, 0], xy[c, 1]
        # twice the signed area; outward normals towards the camera give a negative one (y down)
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        x0 = max(0, int(np.ceil(min(ax, min(bx, cx)))))
        x1 = min(w - 1, int(np.floor(max(ax, max(bx, cx)))))
        y0 = max(0, int(np.ceil(min(ay, min(by, cy)))))
        y1 = min(h - 1, int(np.floor(max(ay, max(by, cy)))))
        shown[n] = t
        boxes[n, 0], boxes[n, 1], boxes[n, 2], boxes[n, 3] = x0, x1, y0, y1
        before = (depth[a] > 0.05) & (depth[b] > 0.05) & (depth[c] > 0.05)
        n += int(before & (area < 0.0) & (x0 <= x1) & (y0 <= y1))
    return n


@kernel(inline="always")
def _draw(
    xy: Array,
    depth: Array,
    triangles: NDArray[np.int32],
    t: int,
    box: NDArray[np.int32],
    stride: int,
    nearest: NDArray[np.int64],
) -> None:
    """Draw triangle t within its box into `nearest` (h*stride,), the `_nearness` of what is seen there.

    A row of the box is a whole number of the processor's vectors and decides nothing by branches, so that the compiler
    makes one instruction of _LANES pixels; the pixels beyond the box are outside of the triangle, or of the picture.
    """
    a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
    za, zb, zc = depth[a], depth[b], depth[c]
    ax, ay = xy[a, 0], xy[a, 1]
    bx, by = xy[b, 0], xy[b, 1]
    cx, cy = xy[c, 0], xy[c, 1]
    inverse = 1.0 / ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax))
    # barycentric coordinates are affine in x and y
    ub_dx, ub_dy = -(ay - cy) * inverse, (ax - cx) * inverse
    uc_dx, uc_dy = (ay - by) * inverse, -(ax - bx) * inverse
    dz_b, dz_c = zb - za, zc - za
    nowhere, own = _nearness(_FAR, NOTHING), np.int64(np.uint32(t))
    x0, x1 = np.int64(box[0]), np.int64(box[1])
    n = np.uint64((x1 - x0 + _LANES) // _LANES * _LANES)
    for y in range(np.int64(box[2]), np.int64(box[3]) + 1):
        ub_row, uc_row = ub_dy * (y - ay), uc_dy * (y - ay)
        first = np.uint64(y * stride + x0)
        for k in range(n):
            dx = (x0 - ax) + np.float64(np.int64(k))
            ub, uc = ub_dx * dx + ub_row, uc_dx * dx + uc_row
            z = np.float32(za + ub * dz_b + uc * dz_c)
            here = np.int64(z.view(np.int32)) << 32 | own
            here = here if min(ub, min(uc, 1.0 - ub - uc)) >= -1e-9 else nowhere
            nearest[first + k] = min(nearest[first + k], here)


@kernel
def label_triangles(
    triangle_at: NDArray[np.int32], label: NDArray[np.uint8], out: NDArray[np.uint8]
) -> None:
    """out (h,w) = label[triangle], 0 where nothing is seen."""
    h, w = triangle_at.shape
    for y in range(h):
        for x in range(w):
            t = triangle_at[y, x]
            out[y, x] = label[t] if t >= 0 else np.uint8(0)
