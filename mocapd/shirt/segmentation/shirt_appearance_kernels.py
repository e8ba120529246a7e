"""Compiled: the ten colours' Gaussians in a camera's own space, and their whitening maps."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]


@njit(cache=True, nogil=True)
def gaussians(
    W: Array,
    sums: Array,
    prior_px: float,
    model_mean: Array,
    model_covariance: Array,
    cloth_sd: float,
    noise_sd: float,
    shading_sd: float,
    mean: Array,
    covariance: Array,
) -> None:
    """Fill mean (N,3) and covariance (N,3,3) in BGR 0..1; see `appearance.gaussians`."""
    N = model_mean.shape[0]
    inverse = np.linalg.inv(W)[::-1].copy()  # rows to b, g, r
    for k in range(N):
        cloth = model_covariance[k].copy()
        for i in range(3):
            cloth[i, i] += cloth_sd * cloth_sd
        n = sums[k, 0]
        trust = n / (n + prior_px)
        for i in range(3):
            expected = 0.0
            for j in range(3):
                expected += inverse[i, j] * model_mean[k, j]
            learned = sums[k, 1 + i] / n if n > 0.0 else expected
            mean[k, i] = trust * learned + (1.0 - trust) * expected
        for i in range(3):
            for j in range(3):
                total = shading_sd * shading_sd * mean[k, i] * mean[k, j]
                for p in range(3):
                    for q in range(3):
                        total += inverse[i, p] * cloth[p, q] * inverse[j, q]
                covariance[k, i, j] = total
            covariance[k, i, i] += noise_sd * noise_sd


@njit(cache=True, nogil=True)
def whitening(mean: Array, covariance: Array, out: NDArray[np.float32]) -> None:
    """Fill out (N,3,4), float32: |out (b,g,r,1)| is the Mahalanobis distance of a BGR 0..255 pixel."""
    for k in range(mean.shape[0]):
        # rows of the inverse Cholesky factor
        A = np.linalg.inv(np.linalg.cholesky(covariance[k]))
        for i in range(3):
            shift = 0.0
            for j in range(3):
                out[k, i, j] = A[i, j] / 255.0
                shift -= A[i, j] * mean[k, j]
            out[k, i, 3] = shift
