"""Least-squares rotation or rigid transform between two sets of points or directions (Kabsch, Umeyama)."""

import numpy as np

from mocapd.geometry.rigid_transforms import RigidTransform
from mocapd.types import Floats


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
