"""Penalties of projected limbs: their long edges against the edge image, a grid on them against reference colours."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel
from mocapd.published.hecht2009.cylinders.cylinder_projection_kernels import (
    project_frustum,
    to_camera_frame,
)
from mocapd.published.hecht2009.cylinders.occlusion_kernels import OcclusionModel, is_hidden
from mocapd.published.hecht2009.cylinders.work_camera import WorkCamera
from mocapd.published.hecht2009.edge_kernels import FULL
from mocapd.published.hecht2009.vector_kernels import Array, dot, minus

Bytes = NDArray[np.uint8]
Singles = NDArray[np.float32]


class Sampling(NamedTuple):
    """See LimbScoreParams, whose fields these are. occlusion: the nearer part of a folded limb hides the farther."""

    along: int
    across: int
    colour_cap: float
    shading: float
    hidden_by_m: float
    occlusion: bool


@kernel(inline="always")
def covers(q: Array, turn: float, x: float, y: float) -> bool:
    """Whether the point is in a convex quadrilateral (4,2); turn: 1 or -1, the sign of its area."""
    for k in range(4):
        m = (k + 1) & 3
        dx, dy = q[m, 0] - q[k, 0], q[m, 1] - q[k, 1]
        if turn * (dx * (y - q[k, 1]) - dy * (x - q[k, 0])) < 0.0:
            return False
    return True


@kernel(error_model="numpy")
def across_view(a: Array, b: Array) -> float:
    """Sine of the angle between the axis a b, points of the camera's frame (3,), and the ray to its middle."""
    m, d = (a[0] + b[0], a[1] + b[1], a[2] + b[2]), minus(b, a)
    mm, dd, md = dot(m, m), dot(d, d), dot(m, d)
    if mm * dd == 0.0:
        return 0.0
    sine: float = np.sqrt(max(1.0 - md * md / (mm * dd), 0.0))
    return sine


@kernel(error_model="numpy")
def score_in_view(
    points: Array,
    radii: Array,
    camera: WorkCamera,
    colour: Bytes,
    edges: NDArray[np.int16],
    reference: Singles,
    occlusion: OcclusionModel,
    others: int,
    sampling: Sampling,
    mean: Array,
    seen: Array,
) -> None:
    """Mean penalty (N,2), 0..1, of those edge and surface samples of N limbs that are seen in one picture, and the share
    seen (N,2) of all: of none, both are 0.

    points (N,3,3) [m, world]; radii (2,2) [m]; colour (h,w,3), edges (h,w,3) of `vision.motion_edges`; reference
    (2,R,3): colours of both parts along their axes, R samples at the middles of as many rows, NaN: not known; others:
    bits of the parts that may hide the limb. A sample of a part that points at the camera counts by the sine of the
    angle, as its samples lie close together.
    """
    along, across, colour_cap, shading, hidden_by_m, folds = sampling
    least_gain, most_gain = np.float32(1.0 - shading), np.float32(1.0 + shading)
    h, w, _ = edges.shape
    p = np.empty((3, 3))
    quads = np.empty((2, 4, 2))
    before = np.empty(2, np.bool_)
    turn = np.empty(2)
    cosine, sine = np.empty(2), np.empty(2)
    per_sad = np.float32(1.0 / colour_cap)
    for n in range(points.shape[0]):
        for i in range(3):
            to_camera_frame(camera, points[n, i], p[i])
        for f in range(2):
            q = quads[f]
            before[f] = project_frustum(camera, p[f], p[f + 1], radii[f, 0], radii[f, 1], q)
            area = (q[2, 0] - q[0, 0]) * (q[3, 1] - q[1, 1])
            area -= (q[2, 1] - q[0, 1]) * (q[3, 0] - q[1, 0])
            turn[f] = 1.0 if area > 0.0 else -1.0
        nearer = 0 if p[0, 2] < p[2, 2] else 1
        folded = folds and before[0] and before[1]
        edge = surface = n_edge = n_surface = 0.0
        for f in range(2):
            if not before[f]:
                continue
            quad = quads[f]
            size = across_view(p[f], p[f + 1])
            for e in range(2):
                m, q = 3 * e, 1 + e
                dx, dy = quad[q, 0] - quad[m, 0], quad[q, 1] - quad[m, 1]
                # of the edge's normal
                f2 = 1.0 / max(dx * dx + dy * dy, 1e-12)
                cosine[e], sine[e] = f2 * (dy * dy - dx * dx), -2.0 * f2 * dx * dy
            for j in range(along):
                s = (j + 0.5) / along
                # both ends of the row, on the two long edges
                ax = (1.0 - s) * quad[0, 0] + s * quad[1, 0]
                ay = (1.0 - s) * quad[0, 1] + s * quad[1, 1]
                bx = (1.0 - s) * quad[3, 0] + s * quad[2, 0]
                by = (1.0 - s) * quad[3, 1] + s * quad[2, 1]
                depth = (1.0 - s) * p[f, 2] + s * p[f + 1, 2]
                blue, green, red = reference[f, j, 0], reference[f, j, 1], reference[f, j, 2]
                known = blue == blue
                per_bright = np.float32(1.0) / max(blue + green + red, np.float32(1.0))
                for k in range(-1, across + 1):
                    on_edge = k < 0 or k == across
                    if not on_edge and not known:
                        continue
                    c = 0.0 if k < 0 else (1.0 if k == across else (k + 0.5) / across)
                    x, y = ax + c * (bx - ax), ay + c * (by - ay)
                    if not (x >= -0.5 and x < w - 0.5 and y >= -0.5 and y < h - 0.5):
                        continue
                    if is_hidden(occlusion, others, x, y, depth, hidden_by_m):
                        continue
                    if folded and f != nearer and covers(quads[nearer], turn[nearer], x, y):
                        continue
                    if on_edge:
                        at = edges[int(y + 0.5), int(x + 0.5)]
                        # edges count by how well they run along the limb's
                        e = 0 if k < 0 else 1
                        found = 0.5 * (at[0] + cosine[e] * at[1] + sine[e] * at[2])
                        off = 1.0 - min(found * (1.0 / FULL), 1.0)
                        edge += size * off * off
                        n_edge += size
                    else:
                        pixel = colour[int(y + 0.5), int(x + 0.5)]
                        # a round part is lighter on one side: its colour, as bright as the pixel within bounds
                        bright = np.float32(pixel[0]) + np.float32(pixel[1]) + np.float32(pixel[2])
                        gain = min(max(bright * per_bright, least_gain), most_gain)
                        sad = (
                            abs(pixel[0] - gain * blue)
                            + abs(pixel[1] - gain * green)
                            + abs(pixel[2] - gain * red)
                        )
                        surface += size * min(sad * per_sad, np.float32(1.0))
                        n_surface += size
        mean[n, 0], seen[n, 0] = edge / max(n_edge, 1e-9), n_edge / (4 * along)
        mean[n, 1], seen[n, 1] = surface / max(n_surface, 1e-9), n_surface / (2 * along * across)
