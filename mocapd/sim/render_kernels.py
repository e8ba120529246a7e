"""A z-buffer renderer of its own; the tracker's id-map rasteriser shares nothing with it."""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel
from mocapd.sim.person.dress_kernels import FLAT, Dress, surface_colour
from mocapd.types import Floats, Singles

_NEAR_M = 0.10
_MOST_OUTSIDE = 1.5  # of the picture's half diagonal, from its middle


@kernel
def project_vertices(
    vertices: Floats,
    R: Floats,
    t: Floats,
    K: Floats,
    dist: Floats,
    size: tuple[int, int],
    out: Floats,
) -> tuple[int, int, int, int]:
    """World points (V,3) to out (V,3): pixel x, y through the lens, and depth [m] (Brown-Conrady).

    Far outside of the picture, where the lens's polynomial may fold back into it, the depth is 0.
    Returns the box x0 y0 x1 y1 [px] inside the picture of size (W, H) that holds all of them.
    """
    x0, y0, x1, y1 = 1e9, 1e9, -1e9, -1e9
    wide = max(K[0, 2], size[0] - K[0, 2]) / K[0, 0]
    high = max(K[1, 2], size[1] - K[1, 2]) / K[1, 1]
    r2_most = _MOST_OUTSIDE * _MOST_OUTSIDE * (wide * wide + high * high)
    for i in range(len(vertices)):
        x = R[0, 0] * vertices[i, 0] + R[0, 1] * vertices[i, 1] + R[0, 2] * vertices[i, 2] + t[0]
        y = R[1, 0] * vertices[i, 0] + R[1, 1] * vertices[i, 1] + R[1, 2] * vertices[i, 2] + t[1]
        z = R[2, 0] * vertices[i, 0] + R[2, 1] * vertices[i, 1] + R[2, 2] * vertices[i, 2] + t[2]
        out[i, 2] = z
        if z < _NEAR_M:
            continue
        x, y = x / z, y / z
        r2 = x * x + y * y
        if r2 > r2_most:
            out[i, 2] = 0.0
            continue
        bend = 1.0 + r2 * (dist[0] + r2 * (dist[1] + r2 * dist[4]))
        u = x * bend + 2 * dist[2] * x * y + dist[3] * (r2 + 2 * x * x)
        v = y * bend + dist[2] * (r2 + 2 * y * y) + 2 * dist[3] * x * y
        out[i, 0] = K[0, 0] * u + K[0, 1] * v + K[0, 2]
        out[i, 1] = K[1, 1] * v + K[1, 2]
        x0, x1 = min(x0, out[i, 0]), max(x1, out[i, 0])
        y0, y1 = min(y0, out[i, 1]), max(y1, out[i, 1])
    left, top = int(min(max(x0 - 1, 0), size[0])), int(min(max(y0 - 1, 0), size[1]))
    right, bottom = int(min(max(x1 + 2, 0), size[0])), int(min(max(y1 + 2, 0), size[1]))
    return left, top, right, bottom


@kernel
def rasterise(
    points: Floats, triangles: NDArray[np.int32], shift_x: float, shift_y: float,
    nearness: Singles, owner: NDArray[np.int32], weights: Singles,
) -> None:  # fmt: skip
    """Fill nearness (H,W) 1/depth, owner (H,W) triangle and weights (H,W,2) of its corners 1 and 2.

    points (V,3) as `project_vertices` gives them, moved by the shift [px]. Corner weights are
    perspective-correct: linear in the scene, not in the picture. Only fronts of triangles are
    drawn (counter-clockwise from outside is clockwise here, y points down), and those that reach
    behind the near plane are left out.
    """
    height, width = nearness.shape
    for k in range(len(triangles)):
        a, b, c = triangles[k, 0], triangles[k, 1], triangles[k, 2]
        if points[a, 2] < _NEAR_M or points[b, 2] < _NEAR_M or points[c, 2] < _NEAR_M:
            continue
        ax, ay = points[a, 0] + shift_x, points[a, 1] + shift_y
        bx, by = points[b, 0] + shift_x, points[b, 1] + shift_y
        cx, cy = points[c, 0] + shift_x, points[c, 1] + shift_y
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if area >= 0.0:
            continue
        x0 = max(int(np.ceil(min(ax, bx, cx))), 0)
        x1 = min(int(np.floor(max(ax, bx, cx))), width - 1)
        y0 = max(int(np.ceil(min(ay, by, cy))), 0)
        y1 = min(int(np.floor(max(ay, by, cy))), height - 1)
        wa, wb, wc = 1.0 / points[a, 2], 1.0 / points[b, 2], 1.0 / points[c, 2]
        # corner weights are linear in x: s = s0 + x ds and so on, along each line
        inverse = 1.0 / area
        ds, dt = -(cy - by) * inverse, -(ay - cy) * inverse
        for y in range(y0, y1 + 1):
            s = ((cx - bx) * (y - by) + (cy - by) * bx) * inverse + x0 * ds
            t = ((ax - cx) * (y - cy) + (ay - cy) * cx) * inverse + x0 * dt
            for x in range(x0, x1 + 1):
                r = 1.0 - s - t
                if s >= 0.0 and t >= 0.0 and r >= 0.0:
                    near = s * wa + t * wb + r * wc
                    if near > nearness[y, x]:
                        nearness[y, x] = near
                        owner[y, x] = k
                        weights[y, x, 0] = t * wb / near
                        weights[y, x, 1] = r * wc / near
                s += ds
                t += dt


@kernel
def accumulate(
    triangles: NDArray[np.int32], albedo: Floats, irradiance: Singles, nearness: Singles,
    owner: NDArray[np.int32], weights: Singles, box: tuple[int, int, int, int], share: float,
    dress: Dress, jackets: Floats, colour: Singles, cover: Singles,
) -> None:  # fmt: skip
    """Add one drawing, worth `share`, to colour (H,W,3) and cover (H,W) within box x0 y0 x1 y1.

    jackets (N,): how far each person's is on. Leaves nearness and owner empty for the next drawing.
    """
    x0, y0, x1, y1 = box
    rgb = np.empty(3)
    rest, rule, under_jacket, person, outfits = dress
    for y in range(y0, y1):
        for x in range(x0, x1):
            k = owner[y, x]
            if k < 0:
                continue
            a, b, c = triangles[k, 0], triangles[k, 1], triangles[k, 2]
            q, r = weights[y, x, 0], weights[y, x, 1]
            p = 1.0 - q - r
            for i in range(3):
                rgb[i] = albedo[k, i]
            if rule[k] != FLAT or under_jacket[k] != FLAT:
                # compiled into this kernel: the cache of compiled code knows of a change there by this file alone
                surface_colour(
                    p * rest[a, 0] + q * rest[b, 0] + r * rest[c, 0],
                    p * rest[a, 1] + q * rest[b, 1] + r * rest[c, 1],
                    p * rest[a, 2] + q * rest[b, 2] + r * rest[c, 2],
                    rule[k], under_jacket[k], person[k], jackets[person[k]], outfits, rgb,
                )  # fmt: skip
            for i in range(3):
                light = p * irradiance[a, i] + q * irradiance[b, i] + r * irradiance[c, i]
                colour[y, x, i] += share * rgb[i] * light
            cover[y, x] += share
            nearness[y, x] = 0.0
            owner[y, x] = -1


@kernel
def draw_depth(
    vertices: Floats, triangles: NDArray[np.int32], view: Floats, points: Floats, depth: Singles
) -> None:
    """The person as a lamp sees her: depth (S,S) [m], huge where she is not; view as in `shadow_at`."""
    size = depth.shape[0]
    depth[:] = 1e9
    for i in range(len(vertices)):
        x, y, z = vertices[i, 0], vertices[i, 1], vertices[i, 2]
        u = view[0] * x + view[1] * y + view[2] * z + view[9]
        v = view[3] * x + view[4] * y + view[5] * z + view[10]
        w = view[6] * x + view[7] * y + view[8] * z + view[11]
        scale = view[12] if view[13] > 0.5 else view[12] / max(w, 0.05)
        points[i, 0], points[i, 1] = scale * u + 0.5 * size - 0.5, scale * v + 0.5 * size - 0.5
        points[i, 2] = w
    for k in range(len(triangles)):
        a, b, c = triangles[k, 0], triangles[k, 1], triangles[k, 2]
        ax, ay, bx, by = points[a, 0], points[a, 1], points[b, 0], points[b, 1]
        cx, cy = points[c, 0], points[c, 1]
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if area == 0.0:
            continue
        x0, x1 = max(int(np.ceil(min(ax, bx, cx))), 0), min(int(max(ax, bx, cx)), size - 1)
        y0, y1 = max(int(np.ceil(min(ay, by, cy))), 0), min(int(max(ay, by, cy)), size - 1)
        for y in range(y0, y1 + 1):
            for x in range(x0, x1 + 1):
                s = ((cx - bx) * (y - by) - (cy - by) * (x - bx)) / area
                t = ((ax - cx) * (y - cy) - (ay - cy) * (x - cx)) / area
                if s >= 0.0 and t >= 0.0 and s + t <= 1.0:
                    z = s * points[a, 2] + t * points[b, 2] + (1.0 - s - t) * points[c, 2]
                    depth[y, x] = min(depth[y, x], z)
