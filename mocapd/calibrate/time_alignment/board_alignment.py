"""The transform between two cameras that see one board, each with roughly calibrated intrinsics.

A focal length that is wrong by some percent stretches a camera's measurements along its axis. So the transform is not
quite rigid: affine, and regularised towards the rigid one.
"""

from dataclasses import dataclass

import numpy as np

from mocapd.types import Floats

_HOLD_M2 = 0.04  # how tight: (1 cm of a corner / 5 % of stretch)^2


@dataclass(frozen=True, slots=True, eq=False)
class Affine:
    """x_a = L x_b + t_m; L (...,3,3), t_m (...,3) [m]."""

    L: Floats
    t_m: Floats

    def __getitem__(self, index: int) -> "Affine":
        """One of a batch."""
        return Affine(self.L[index], self.t_m[index])

    def apply(self, points_m: Floats) -> Floats:
        """Points (...,4,3) of b in a [m]; a batch (K,) goes along the axis before the points."""
        if self.L.ndim == 2:  # one product, not one for each board, which takes three times as long
            flat: Floats = points_m.reshape(-1, 3) @ self.L.T + self.t_m
            return flat.reshape(points_m.shape)
        out: Floats = points_m @ np.swapaxes(self.L, -1, -2) + self.t_m[..., None, :]
        return out

    def inverse(self) -> "Affine":
        """b_from_a."""
        L: Floats = np.asarray(np.linalg.inv(self.L), dtype=np.float64)
        return Affine(L, -np.einsum("...ij,...j->...i", L, self.t_m))


def align_affine(a_m: Floats, b_m: Floats, weight: Floats) -> Affine:
    """Least-squares a_from_b (K,) of corners a_m (T,4,3) and b_m (T,K,4,3) with weights (T,K).

    The rigid one first (Kabsch, Acta Cryst. A32, 1976), then the affine one near it.
    """
    w = weight / np.maximum(weight.sum(axis=0), 1e-12)
    middle_a = w.T @ a_m.mean(axis=1)
    middle_b = np.einsum("tk,tki->ki", w, b_m.mean(axis=2))
    arm_a = a_m[:, None] - middle_a[:, None]  # (T,K,4,3)
    arm_b = b_m - middle_b[:, None]
    flat_a = arm_a.transpose(1, 0, 2, 3).reshape(len(middle_a), -1, 3)
    flat_b = arm_b.transpose(1, 0, 2, 3).reshape(len(middle_a), -1, 3)
    flat_w = np.repeat(weight.T, 4, axis=1)[:, None]
    across = (np.swapaxes(flat_a, 1, 2) * flat_w) @ flat_b
    within = (np.swapaxes(flat_b, 1, 2) * flat_w) @ flat_b
    U, _, Vt = np.linalg.svd(across)
    U[:, :, 2] *= np.sign(np.linalg.det(U @ Vt))[:, None]
    R = U @ Vt
    hold = _HOLD_M2 * np.eye(3)
    L = np.swapaxes(np.linalg.solve(within + hold, np.swapaxes(across + _HOLD_M2 * R, 1, 2)), 1, 2)
    return Affine(L, middle_a - np.einsum("kij,kj->ki", L, middle_b))
