"""Slow, obvious twins of the kernels in mocapd/vision, straight from the paper's formulas."""

import numpy as np

from mocapd.shirt.colour.colour_model import ColourModel
from mocapd.types import Bytes, Floats, Singles

NAMES = ("red", "orange", "yellow", "lime", "green", "cyan", "blue", "violet", "magenta", "pink")
MEANS = np.array(
    [
        [0.73, 0.16, 0.19],
        [0.88, 0.45, 0.15],
        [0.85, 0.74, 0.18],
        [0.50, 0.71, 0.21],
        [0.14, 0.46, 0.24],
        [0.16, 0.61, 0.67],
        [0.17, 0.29, 0.66],
        [0.37, 0.23, 0.50],
        [0.72, 0.19, 0.49],
        [0.83, 0.56, 0.63],
    ]
)


def example_model(seed: int = 0) -> ColourModel:
    """Ten well separated colours with skewed covariances."""
    spread = np.random.default_rng(seed).normal(0.0, 0.04, (10, 3, 3))
    covariance = spread @ spread.transpose(0, 2, 1) + 0.03**2 * np.eye(3)
    return ColourModel(NAMES, MEANS, covariance, "test")


def example_white_balance() -> Floats:
    return np.array([[1.10, 0.12, -0.03], [0.05, 0.95, 0.10], [0.00, 0.15, 1.30]])


def mahalanobis(pixels: Bytes | Floats, W: Floats, model: ColourModel) -> Floats:
    """(h,w,10): |W I - mu_k|_Sigma_k of every pixel (h,w,3) BGR."""
    balanced = pixels[..., ::-1] / 255.0 @ W.T
    distances = np.empty((*pixels.shape[:2], 10))
    for k in range(10):
        difference = balanced - model.mean[k]
        precision = np.linalg.inv(model.tolerant_covariance[k])
        distances[..., k] = np.sqrt(np.einsum("hwi,ij,hwj->hw", difference, precision, difference))
    return distances


def classify(costs: Floats, threshold: float, mask: Bytes) -> Bytes:
    """(h,w) ids from the costs (h,w,10) of steps 1 or 3."""
    ids: Bytes = (costs.argmin(axis=2) + 1).astype(np.uint8)
    ids[(costs.min(axis=2) >= threshold) | (mask == 0)] = 0
    return ids


def distance_maps(ids: Bytes, limit_px: float) -> Singles:
    """(10,h,w) by trying every sample."""
    h, w = ids.shape
    distances = np.full((10, h, w), limit_px, dtype=np.float32)
    rows, columns = np.mgrid[:h, :w]
    for k in range(10):
        for y, x in np.argwhere(ids == k + 1):
            np.minimum(distances[k], np.hypot(rows - y, columns - x), out=distances[k])
    return distances


def chrominance_triangle(pixel_bgr: Bytes) -> tuple[int, int, int]:
    """Which of the hundred triangles holds a pixel: its barycentric cell."""
    b, g, r = (int(value) for value in pixel_bgr)
    total = b + g + r
    return 10 * r // total, 10 * g // total, 10 * b // total


def uniformity(bins: Bytes, radius: int, cap: float) -> Floats:
    """(gh,gw): sum_i min(h_i, cap) of the window around each sample; 255 is no colour."""
    u = np.zeros(bins.shape)
    area = (2 * radius + 1) ** 2
    for i in range(bins.shape[0]):
        for j in range(bins.shape[1]):
            window = bins[
                max(0, i - radius) : i + radius + 1, max(0, j - radius) : j + radius + 1
            ].ravel()
            histogram = np.bincount(window[window < 100], minlength=100) / area
            u[i, j] = np.minimum(histogram, cap).sum()
    return u
