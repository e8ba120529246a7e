"""Slow twins of the cylinders' kernels, and a small body to try them on."""

from collections.abc import Sequence

import numpy as np

from mocapd.geometry.camera_model import project, to_camera
from mocapd.published.hecht2009.cylinders.limb_params import LimbScoreParams
from mocapd.published.hecht2009.cylinders.limb_score import (
    LimbView,
    UsualPenalties,
    limb_penalties,
    log_scores,
)
from mocapd.published.hecht2009.edge_kernels import FULL
from mocapd.types import Camera, Floats

WORK_PX = 320, 240
# head, upper and lower trunk; upper arm and forearm, thigh and shank, the left first
ENDS_M = np.array([
    [[0.0, 1.50, 0.02], [0.0, 1.75, 0.02]], [[0.0, 1.42, 0.0], [0.0, 1.20, 0.0]],
    [[0.0, 1.20, 0.0], [0.0, 0.95, 0.0]],
    [[0.19, 1.40, 0.0], [0.35, 1.15, 0.05]], [[0.35, 1.15, 0.05], [0.30, 0.95, 0.22]],
    [[-0.19, 1.40, 0.0], [-0.30, 1.15, 0.1]], [[-0.30, 1.15, 0.1], [-0.05, 1.10, 0.25]],
    [[0.09, 0.95, 0.0], [0.11, 0.50, 0.05]], [[0.11, 0.50, 0.05], [0.11, 0.08, 0.0]],
    [[-0.09, 0.95, 0.0], [-0.11, 0.50, 0.0]], [[-0.11, 0.50, 0.0], [-0.12, 0.08, 0.0]],
])  # fmt: skip
RADII_M = np.array(
    [[0.08, 0.08], [0.17, 0.14], [0.14, 0.17]]
    + [[0.06, 0.05], [0.05, 0.035]] * 2
    + [[0.09, 0.065], [0.06, 0.045]] * 2
)
LEFT_ARM = (3, 4)


def limb_of(ends_m: Floats, parts: tuple[int, int]) -> Floats:
    """The three points (3,3) of a limb of two parts."""
    return np.array([ends_m[parts[0], 0], ends_m[parts[0], 1], ends_m[parts[1], 1]])


def camera(x_m: float = 0.0, k1: float = -0.12) -> Camera:
    """Before the body at 2.7 m, a webcam with its lens, looking along -Z."""
    R = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])
    K = np.array([[560.0, 0.0, 318.0], [0.0, 556.0, 243.0], [0.0, 0.0, 1.0]])
    return Camera(
        "c",
        (640, 480),
        K,
        np.array([k1, 0.05, 0.001, -0.002, 0.0]),
        R,
        -R @ np.array([x_m, 1.0, 2.7]),
    )


def naive_quad(of: Camera, a_m: Floats, b_m: Floats, radii_m: Floats) -> Floats:
    """Corners (4,2) [work px] of a part, by the camera model."""
    eye = -of.R.T @ of.t_m
    n = np.cross(a_m - eye, b_m - eye)
    n /= np.linalg.norm(n)
    corners = np.array(
        [a_m + radii_m[0] * n, b_m + radii_m[1] * n, b_m - radii_m[1] * n, a_m - radii_m[0] * n]
    )
    return (project(of, corners) + 0.5) * 0.5 - 0.5


def inside(quad: Floats, xy: Floats) -> bool:
    """Whether a point is in a convex quadrilateral, whichever way round it goes."""
    side = [np.linalg.det([quad[(k + 1) % 4] - quad[k], xy - quad[k]]) for k in range(4)]
    return bool(min(side) >= 0.0 or max(side) <= 0.0)


def naive_hidden(
    quads: Floats, depths: Floats, own: set[int], xy: Floats, depth: float, margin: float
) -> bool:
    """Whether a part other than `own` covers the sample and is nearer there."""
    for c, (quad, (near, far)) in enumerate(zip(quads, depths, strict=True)):
        if c in own or not inside(quad, xy):
            continue
        start, end = 0.5 * (quad[0] + quad[3]), 0.5 * (quad[1] + quad[2])
        along = (xy - start) @ (end - start) / max((end - start) @ (end - start), 1.0)
        at = near + along * (far - near)
        if min(max(at, min(near, far)), max(near, far)) < depth - margin:
            return True
    return False


def naive_penalties(
    of: Camera,
    limb_m: Floats,
    parts: tuple[int, int],
    body: tuple[Floats, Floats],
    view: LimbView,
    params: LimbScoreParams,
) -> tuple[Floats, Floats]:
    """Mean penalties (2,) of edges and surface of one limb and the shares seen (2,), sample by sample; body: quads and
    depths of all parts."""
    h, w, _ = view.edges.shape
    total, seen = np.zeros(2), np.zeros(2)
    quads = [naive_quad(of, limb_m[f], limb_m[f + 1], RADII_M[parts[f]]) for f in range(2)]
    z = to_camera(of, limb_m)[:, 2]
    nearer = 0 if z[0] < z[2] else 1

    def visible(f: int, xy: Floats, depth: float) -> bool:
        if not (-0.5 <= xy[0] < w - 0.5 and -0.5 <= xy[1] < h - 0.5):
            return False
        if f != nearer and inside(quads[nearer], xy):
            return False
        return not naive_hidden(*body, set(parts), xy, depth, params.hidden_by_m)

    for f, part in enumerate(parts):
        a, b = limb_m[f], limb_m[f + 1]
        quad, middle = quads[f], 0.5 * to_camera(of, a + b) + 0.5 * of.t_m
        axis = of.R @ (b - a)
        across = np.cross(axis, middle) / np.linalg.norm(axis) / np.linalg.norm(middle)
        size = float(np.linalg.norm(across))
        for j in range(params.along):
            s = (j + 0.5) / params.along
            sides = (1 - s) * quad[0] + s * quad[1], (1 - s) * quad[3] + s * quad[2]
            depth = (1 - s) * z[f] + s * z[f + 1]
            for xy, edge in zip(sides, (quad[1] - quad[0], quad[2] - quad[3]), strict=True):
                if visible(f, xy, depth):
                    x, y = np.floor(xy + 0.5).astype(int)
                    strength, cosine, sine = view.edges[y, x] / FULL
                    normal = 2.0 * np.arctan2(edge[0], -edge[1])
                    found = 0.5 * (strength + cosine * np.cos(normal) + sine * np.sin(normal))
                    total[0] += size * (1.0 - min(found, 1.0)) ** 2
                    seen[0] += size
            for k in range(params.across):
                xy = sides[0] + (k + 0.5) / params.across * (sides[1] - sides[0])
                wanted = view.reference[part, j].astype(float)
                if np.isfinite(wanted).all() and visible(f, xy, depth):
                    x, y = np.floor(xy + 0.5).astype(int)
                    pixel = view.colour[y, x].astype(float)
                    gain = np.clip(
                        pixel.sum() / wanted.sum(), 1.0 - params.shading, 1.0 + params.shading
                    )
                    sad = np.abs(pixel - gain * wanted).sum()
                    total[1] += size * min(sad / params.colour_cap, 1.0)
                    seen[1] += size
    return total / np.maximum(seen, 1e-9), seen / (params.along * np.array([4, 2 * params.across]))


def score_limbs(
    points_m: Floats,
    radii_m: Floats,
    parts: tuple[int, int],
    views: Sequence[LimbView],
    usual: UsualPenalties,
    params: LimbScoreParams,
) -> Floats:
    """Logarithm (N,) of the likelihoods of N particles; arguments as of `limb_penalties` and `log_scores`."""
    return log_scores(limb_penalties(points_m, radii_m, parts, views, params), usual, views, params)
