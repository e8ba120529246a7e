"""What the kernels take: named tuples of arrays, passed as one argument.

All arrays are C-contiguous and writable, so that each kernel is compiled for one set of types. Kernels
unpack them in their first lines, so that they take `plain` ones as well.
"""

from typing import Any, NamedTuple, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from mocapd.types import Camera, Floats, Ints

Int32s = NDArray[np.int32]
_Arrays = TypeVar("_Arrays", bound=tuple[Any, ...])


def plain(arrays: _Arrays) -> _Arrays:
    """The same without its name, for kernels that are called in every frame.

    To call a compiled function takes 0.8 us more for each named tuple among its arguments and 0.1 us
    for a plain one: over all kernels of a frame, 4 % of it. Each form is compiled for itself.
    """
    return cast(_Arrays, tuple(arrays))


class Articulation(NamedTuple):
    """How joints hang on each other and move together; J joints, G rotation groups, N shape factors."""

    parents: Ints  # (J,)
    group_of_joint: Ints  # (J,), -1: does not move
    share_of_joint: Floats  # (J,)
    joint_of_group: Ints  # (G,) the first joint of each group
    d_rest: Floats  # (N,J,3)


class SkinArrays(NamedTuple):
    """Which bones carry each vertex."""

    bones: Int32s  # (V,B)
    weights: Floats  # (V,B)


class TriangleArrays(NamedTuple):
    """The triangles of the surface; bones and weights are those of the triangle's centre; stiffness: what share of the pull
    at it the bones feel."""

    corners: Int32s  # (T,3)
    bones: Int32s  # (T,B)
    weights: Floats  # (T,B)
    stiffness: Floats  # (T,)
    d_centres: Floats  # (N,T,3)


class PosedJoints(NamedTuple):
    """A pose of one body: T-pose joints [m], global rotations, joint centres in the world [m]."""

    rest: Floats  # (J,3)
    R: Floats  # (J,3,3)
    joints: Floats  # (J,3)
    quats: Floats  # (J,4)


class CameraArrays(NamedTuple):
    """camera_from_world R (3,3), t (3,) [m]; K (3,3) [px], dist (5,)."""

    R: Floats
    t: Floats
    K: Floats
    dist: Floats


class PinholeArrays(NamedTuple):
    """camera_from_world R (3,3), t (3,) [m], and the focal lengths in px of the picture at hand."""

    R: Floats
    t: Floats
    fx: float
    fy: float


def camera_arrays(camera: Camera) -> CameraArrays:
    """Copies of what a camera's kernels need."""
    return CameraArrays(
        *(np.array(a, dtype=np.float64, order="C") for a in (camera.R, camera.t_m, camera.K, camera.dist))
    )  # fmt: skip


def pinhole_arrays(camera: CameraArrays, image_scale: float) -> PinholeArrays:
    """The same without the lens' distortion, for pictures averaged down by `image_scale`."""
    fx, fy = float(camera.K[0, 0]) / image_scale, float(camera.K[1, 1]) / image_scale
    return PinholeArrays(camera.R, camera.t, fx, fy)
