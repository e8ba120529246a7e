"""Drawing the shirt of a pose as a 40x40 id map, many poses in a row."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapd.body.arrays import SkinArrays
from mocapd.body.model import Shaped
from mocapd.body.posing_kernels import forward_kinematics, quat_multiply, skin_and_project
from mocapd.kernels.decorator import kernel
from mocapd.shirt.pose_database.idmap_crop_kernels import SIZE, crop_window, pack, resample
from mocapd.vision.raster_kernels import label_triangles, rasterise

Array = NDArray[np.float64]
Bytes = NDArray[np.uint8]

CANVAS = 80  # [px] the shirt is drawn at twice the map's resolution, then cropped as a query is


class RenderedPoses(NamedTuple):
    """Id maps of N poses, each with the place of the hips and the size of its crop."""

    packed_maps: Bytes  # (N, SIZE*SIZE/2)
    root_m: NDArray[np.float32]  # (N,3) hips from the ray through the crop's centre; z: depth
    side_rad: NDArray[np.float32]  # (N,) side of the crop [px] over the focal length


@kernel
def render_poses(
    local_xyzw: NDArray[np.float32],
    camera_from_root_xyzw: NDArray[np.float32],
    body: Shaped,
    skin: SkinArrays,
    triangles: NDArray[np.int32],
    colour: Bytes,
    is_shirt: NDArray[np.bool_],
    parents: NDArray[np.int64],
    focal_px: float,
    distance_m: float,
    out: RenderedPoses,
) -> None:
    """Draw N poses into `out`, the middle of the trunk on the optical axis.

    colour (T,): of the triangles; is_shirt (V,): the vertices whose box the canvas is fitted to.
    """
    vertices, rest, _ = body
    packed_maps, root_m, side_rad = out
    J, V = rest.shape[0], vertices.shape[0]
    R, joints, turned = np.empty((J, 3, 3)), np.empty((J, 3)), np.empty((J, 4))
    local = np.empty((J, 4))
    xy, depth = np.empty((V, 2)), np.empty(V)
    zbuffer = np.empty((CANVAS, CANVAS), np.float32)
    triangle_at = np.empty((CANVAS, CANVAS), np.int32)
    ids = np.empty((CANVAS, CANVAS), np.uint8)
    small = np.empty((SIZE, SIZE), np.uint8)
    # arrays by numbers, here and below: numba takes seconds to compile an array's assignment
    K, identity = np.zeros((3, 3)), np.zeros((3, 3))
    for i in range(3):
        K[i, i] = focal_px if i < 2 else 1.0
        identity[i, i] = 1.0
    no_lens, zero = np.zeros(5), np.zeros(2)
    facing, hips = np.empty(4), np.empty(4)
    t, root = np.zeros(3), np.zeros(3)
    # without their names, as the tracker calls that kernel: each form is compiled for itself
    posed: Any = (rest, R, joints, turned)
    camera: Any = (identity, t, K, no_lens)
    for n in range(local_xyzw.shape[0]):
        for j in range(J):
            for i in range(4):
                local[j, i] = local_xyzw[n, j, i]
        for i in range(4):
            facing[i], hips[i] = camera_from_root_xyzw[n, i], local_xyzw[n, 0, i]
        quat_multiply(facing, hips, local[0])
        forward_kinematics(parents, rest, root, local, R, joints, turned)
        for i in range(3):  # joint 3 is the upper chest
            t[i] = -0.5 * (joints[0, i] + joints[3, i])
        t[2] += distance_m
        skin_and_project(vertices, skin, posed, camera, zero, 1.0, xy, depth)
        x0 = y0 = 1e9
        x1 = y1 = -1e9
        for v in range(V):
            if is_shirt[v]:
                x0, x1 = min(x0, xy[v, 0]), max(x1, xy[v, 0])
                y0, y1 = min(y0, xy[v, 1]), max(y1, xy[v, 1])
        scale = (CANVAS - 2) / max(x1 - x0, y1 - y0, 1.0)
        for v in range(V):
            xy[v, 0] = (xy[v, 0] - 0.5 * (x0 + x1)) * scale + 0.5 * (CANVAS - 1)
            xy[v, 1] = (xy[v, 1] - 0.5 * (y0 + y1)) * scale + 0.5 * (CANVAS - 1)
        rasterise(xy, depth, triangles, zbuffer, triangle_at)
        label_triangles(triangle_at, colour, ids)
        cx, cy, side = crop_window(ids)
        for y in range(SIZE):
            for x in range(SIZE):
                small[y, x] = 0
        if side > 0.0:
            resample(ids, cx, cy, side, small)
        pack(small, packed_maps[n])
        # the crop's centre back on the image plane, in focal lengths
        middle_x = ((cx - 0.5 * (CANVAS - 1)) / scale + 0.5 * (x0 + x1)) / focal_px
        middle_y = ((cy - 0.5 * (CANVAS - 1)) / scale + 0.5 * (y0 + y1)) / focal_px
        root_m[n, 0] = t[0] - t[2] * middle_x
        root_m[n, 1] = t[1] - t[2] * middle_y
        root_m[n, 2] = t[2]
        side_rad[n] = side / scale / focal_px
