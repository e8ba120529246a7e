"""Geometry of the person per frame: skinning, normals, and the light that reaches each vertex."""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel
from mocapd.types import Floats, Ints, Singles


@kernel
def skin_vertices(
    vertices: Floats, normals: Floats, folds: Floats, fold_joint: Ints, bend: Floats,
    bones: NDArray[np.int32], weights: Floats, R: Floats, t: Floats, out: Floats,
) -> None:  # fmt: skip
    """Linear blend skinning of vertices (V,3), pushed along their normals by folds times bend, to out."""
    for v in range(len(vertices)):
        h = folds[v] * bend[fold_joint[v]] if fold_joint[v] >= 0 else 0.0
        x = vertices[v, 0] + h * normals[v, 0]
        y = vertices[v, 1] + h * normals[v, 1]
        z = vertices[v, 2] + h * normals[v, 2]
        ox = oy = oz = 0.0
        for k in range(bones.shape[1]):
            w, b = weights[v, k], bones[v, k]
            if w > 0.0:
                ox += w * (R[b, 0, 0] * x + R[b, 0, 1] * y + R[b, 0, 2] * z + t[b, 0])
                oy += w * (R[b, 1, 0] * x + R[b, 1, 1] * y + R[b, 1, 2] * z + t[b, 1])
                oz += w * (R[b, 2, 0] * x + R[b, 2, 1] * y + R[b, 2, 2] * z + t[b, 2])
        out[v, 0], out[v, 1], out[v, 2] = ox, oy, oz


@kernel
def vertex_normals(vertices: Floats, triangles: NDArray[np.int32], out: Floats) -> None:
    """Unit normals (V,3): the faces' normals around each vertex, weighted by their areas."""
    out[:] = 0.0
    for k in range(len(triangles)):
        i, j, m = triangles[k, 0], triangles[k, 1], triangles[k, 2]
        ax = vertices[j, 0] - vertices[i, 0]
        ay = vertices[j, 1] - vertices[i, 1]
        az = vertices[j, 2] - vertices[i, 2]
        bx = vertices[m, 0] - vertices[i, 0]
        by = vertices[m, 1] - vertices[i, 1]
        bz = vertices[m, 2] - vertices[i, 2]
        nx, ny, nz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        for v in (i, j, m):
            out[v, 0] += nx
            out[v, 1] += ny
            out[v, 2] += nz
    for v in range(len(out)):
        size = np.sqrt(out[v, 0] ** 2 + out[v, 1] ** 2 + out[v, 2] ** 2)
        for c in range(3):
            out[v, c] /= max(size, 1e-12)


@kernel
def shadow_at(
    views: Floats, depths: Singles, k: int, x: float, y: float, z: float, bias: float
) -> float:
    """Share 0..1 of the light of lamp k that the person takes from a point of the world, smoothed over 2x2.

    views (L,14): rows of the rotation, translation, focal length [px], 1 for
    parallel light; depths (L,S,S) [m].
    """
    size = depths.shape[1]
    u = views[k, 0] * x + views[k, 1] * y + views[k, 2] * z + views[k, 9]
    v = views[k, 3] * x + views[k, 4] * y + views[k, 5] * z + views[k, 10]
    w = views[k, 6] * x + views[k, 7] * y + views[k, 8] * z + views[k, 11]
    if views[k, 13] < 0.5:
        if w < 0.05:
            return 0.0
        u, v = u / w, v / w
    u = views[k, 12] * u + 0.5 * size - 0.5
    v = views[k, 12] * v + 0.5 * size - 0.5
    i, j = int(np.floor(u)), int(np.floor(v))
    if i < 0 or j < 0 or i >= size - 1 or j >= size - 1:
        return 0.0
    fu, fv = u - i, v - j
    near = w - bias
    top = (1 - fu) * (depths[k, j, i] < near) + fu * (depths[k, j, i + 1] < near)
    low = (1 - fu) * (depths[k, j + 1, i] < near) + fu * (depths[k, j + 1, i + 1] < near)
    return float((1 - fv) * top + fv * low)


@kernel
def light_vertices(
    vertices: Floats, normals: Floats, light_at: Floats, light_rgb: Floats, light_sun: Ints,
    ambient_up: Floats, ambient_down: Floats, views: Floats, depths: Singles, out: Singles,
) -> None:  # fmt: skip
    """Irradiance (V,3) linear RGB: Lambert with each lamp's own shadow map, soft light from around.

    light_rgb (L,3) has the lamps' levels in it; views (L,14), depths (L,S,S) see `shadow_at`.
    """
    for i in range(len(vertices)):
        nx, ny, nz = normals[i, 0], normals[i, 1], normals[i, 2]
        x, y, z = vertices[i, 0], vertices[i, 1], vertices[i, 2]
        up = 0.5 + 0.5 * ny
        for c in range(3):
            out[i, c] = up * ambient_up[c] + (1 - up) * ambient_down[c]
        for k in range(len(light_at)):
            near = 0.0 if light_sun[k] else 1.0
            u = light_at[k, 0] - near * x
            v = light_at[k, 1] - near * y
            w = light_at[k, 2] - near * z
            square = u * u + v * v + w * w
            cosine = (nx * u + ny * v + nz * w) / np.sqrt(square)
            # a shoulder's width of wrap: cloth is not a hard Lambertian edge
            cosine = (cosine + 0.08) / 1.08
            if cosine <= 0.0 or light_rgb[k, 0] + light_rgb[k, 1] + light_rgb[k, 2] <= 0.0:
                continue
            dark = shadow_at(views, depths, k, x + 0.02 * nx, y + 0.02 * ny, z + 0.02 * nz, 0.03)
            strength = cosine * (1.0 - dark) / (1.0 if light_sun[k] else max(square, 0.04))
            for c in range(3):
                out[i, c] += light_rgb[k, c] * strength
