"""Vectors in space for the kernels beside: tuples, which stay in registers, or rows of arrays."""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel

Array = NDArray[np.float64]
Vector = tuple[float, float, float]

TINY = 1e-12


@kernel
def minus(a: Array | Vector, b: Array | Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@kernel
def times(f: float, a: Array | Vector) -> Vector:
    return f * a[0], f * a[1], f * a[2]


@kernel(error_model="numpy")
def over(a: Array | Vector, f: float) -> Vector:
    return a[0] / f, a[1] / f, a[2] / f


@kernel
def dot(a: Array | Vector, b: Array | Vector) -> float:
    product: float = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    return product


@kernel
def cross(a: Array | Vector, b: Array | Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@kernel(error_model="numpy")
def unit(a: Array | Vector) -> Vector:
    """Of length 1, or shorter where a is nothing."""
    return times(1.0 / max(np.sqrt(dot(a, a)), TINY), a)


@kernel
def move(point: Array, f: float, a: Array | Vector) -> None:
    """Add f a to a point, in place."""
    for r in range(3):
        point[r] += f * a[r]
