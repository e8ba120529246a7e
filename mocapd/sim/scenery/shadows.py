"""Shadow maps: the person as each lamp sees her."""

import numpy as np
from numpy.typing import NDArray

from mocapd.sim.render_kernels import draw_depth
from mocapd.sim.scenery.lamps import Lamps
from mocapd.types import Floats, Singles

MAP_PX = 192
_REACH_M = 1.25  # of a person from the middle of her body, arms stretched


def lamp_views(lamps: Lamps, middle_m: Floats) -> Floats:
    """Views (L,14) as `shadow_at` wants them, each with the person's ball filling the map."""
    views = np.zeros((len(lamps.at_m), 14))
    for view, at, sun in zip(views, lamps.at_m, lamps.sun, strict=True):
        eye = middle_m + 10.0 * at if sun else at
        z = middle_m - eye
        distance = float(np.linalg.norm(z))
        z = z / distance
        side = np.array([0.0, 1.0, 0.0]) if abs(z[1]) < 0.95 else np.array([1.0, 0.0, 0.0])
        x = np.cross(z, side)
        x /= np.linalg.norm(x)
        R = np.stack([x, np.cross(z, x), z])
        view[:9], view[9:12] = R.ravel(), -R @ eye
        wide = _REACH_M if sun else min(_REACH_M / distance, 1.6)
        view[12], view[13] = 0.5 * MAP_PX / wide, float(sun)
    return views


def shadow_maps(
    vertices_m: Floats, triangles: NDArray[np.int32], views: Floats, levels: Floats
) -> Singles:
    """Depth (L,S,S) [m] of the person from each lamp that burns."""
    depths = np.full((len(views), MAP_PX, MAP_PX), 1e9, dtype=np.float32)
    points = np.empty_like(vertices_m)
    for view, depth, level in zip(views, depths, levels, strict=True):
        if level > 0.0:
            draw_depth(vertices_m, triangles, view, points, depth)
    return depths
