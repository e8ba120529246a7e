"""Rigid transforms, SE(3): composed, inverted, applied; batched over leading axes."""

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
