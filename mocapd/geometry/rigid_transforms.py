"""Rigid transforms, SE(3): composed, inverted, applied; batched over leading axes.

And the rotation or rigid transform of least squares between two sets of points or directions (Kabsch, Umeyama).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from types import EllipsisType

import numpy as np
from numpy.typing import NDArray

from mocapd.types import Floats

_Index = int | slice | EllipsisType | None | NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class RigidTransform:
    """a_from_b takes a point of b to a: x_a = R x_b + t_m; R (...,3,3), t_m (...,3) [m]."""

    R: Floats
    t_m: Floats

    def __matmul__(self, other: "RigidTransform") -> "RigidTransform":
        """a_from_c of a_from_b and b_from_c; leading axes broadcast."""
        return RigidTransform(self.R @ other.R, self.apply(other.t_m))

    def __getitem__(self, index: _Index | tuple[_Index, ...]) -> "RigidTransform":
        """Transforms of a batch, by an index into its leading axes."""
        return RigidTransform(self.R[index], self.t_m[index])

    def apply(self, points_m: Floats) -> Floats:
        """Points (...,3) of b in a [m]; their leading axes broadcast with those of the transforms."""
        return self.rotate(points_m) + self.t_m

    def rotate(self, vectors: Floats) -> Floats:
        """Directions (...,3) of b in a."""
        rotated: Floats = np.einsum("...ij,...j->...i", self.R, vectors)
        return rotated

    def inverse(self) -> "RigidTransform":
        """b_from_a."""
        R = np.swapaxes(self.R, -1, -2)
        return RigidTransform(R, -np.einsum("...ij,...j->...i", R, self.t_m))


IDENTITY = RigidTransform(np.eye(3), np.zeros(3))


def stack(transforms: Sequence[RigidTransform]) -> RigidTransform:
    """A batch (N,) of single transforms."""
    return RigidTransform(
        np.array([transform.R for transform in transforms]).reshape(-1, 3, 3),
        np.array([transform.t_m for transform in transforms]).reshape(-1, 3),
    )


def concatenate(a: RigidTransform, b: RigidTransform) -> RigidTransform:
    """The transforms of a, then those of b."""
    return RigidTransform(np.concatenate([a.R, b.R]), np.concatenate([a.t_m, b.t_m]))


def nearest_rotation(M: Floats) -> Floats:
    """The rotation (3,3) with the largest trace of R^T M: for a near-rotation M the nearest one.

    By the singular values of M, a reflection excluded (Kabsch, Acta Cryst. A32, 1976; Umeyama,
    PAMI 1991).
    """
    U, _, Vt = np.linalg.svd(M)
    R: Floats = U @ np.diag([1.0, 1.0, np.sign(np.linalg.det(U @ Vt))]) @ Vt
    return R


def align_directions(a: Floats, b: Floats) -> Floats:
    """a_from_b (3,3): the rotation of least squares that takes directions b (N,3) to a (N,3)."""
    return nearest_rotation(a.T @ b)


def align_points(a_m: Floats, b_m: Floats, weights: Floats | None = None) -> RigidTransform:
    """a_from_b of least squares between the same points (N,3) in both frames, weights (N,) >= 0."""
    weights = np.ones(len(a_m)) if weights is None else weights
    w = weights / max(float(weights.sum()), 1e-300)
    middle_a, middle_b = w @ a_m, w @ b_m
    R = align_directions(a_m - middle_a, (b_m - middle_b) * w[:, None])
    return RigidTransform(R, middle_a - R @ middle_b)
