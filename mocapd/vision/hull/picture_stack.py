"""Silhouettes of several cameras as one stack of arrays, with the projections into them, for the kernels of the hull."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapd.types import Camera, Floats, Ints


class StackProjections(NamedTuple):
    """Cameras C. camera_from_world R (C,3,3), t_m (C,3); focal_px (C,4): fx, fy, cx, cy in the stack's pixels; dist (C,5);
    size_px (C,2): width and height of each picture within the stack."""

    R: Floats
    t_m: Floats
    focal_px: Floats
    dist: Floats
    size_px: Ints


def block_px(camera: Camera, size_px: tuple[int, int]) -> int:
    """Side of the blocks of a frame's pixels that the pixels of its work picture are averages of. size_px: width and height
    of the picture, which may lack the last columns and rows of the frame."""
    return max(1, round(camera.size_px[0] / size_px[0]))


def stack_projections(
    cameras: Sequence[Camera], sizes_px: Sequence[tuple[int, int]]
) -> StackProjections:
    """Projections into work pictures of these sizes (width, height), see `block_px`."""
    focal = np.empty((len(cameras), 4))
    for i, (camera, size) in enumerate(zip(cameras, sizes_px, strict=True)):
        scale = 1.0 / block_px(camera, size)
        focal[i, :2] = scale * camera.K[[0, 1], [0, 1]]
        # pixel centres are at integers
        focal[i, 2:] = scale * (camera.K[:2, 2] + 0.5) - 0.5
    return StackProjections(
        np.array([camera.R for camera in cameras], dtype=float).reshape(-1, 3, 3),
        np.array([camera.t_m for camera in cameras], dtype=float).reshape(-1, 3),
        focal,
        np.array([camera.dist for camera in cameras], dtype=float).reshape(-1, 5),
        np.array(sizes_px, dtype=np.int64).reshape(-1, 2),
    )


def stack_pictures(pictures: Sequence[NDArray[np.generic]]) -> NDArray[np.generic]:
    """(C,h,w): pictures (h,w) of one type, the smaller ones with zeros to the right and below."""
    h, w = (max(picture.shape[axis] for picture in pictures) for axis in (0, 1))
    out = np.zeros((len(pictures), h, w), pictures[0].dtype)
    for place, picture in zip(out, pictures, strict=True):
        place[: picture.shape[0], : picture.shape[1]] = picture
    return out
