"""Slow, obvious twins of the kernels in mocapd/published/wang2011, straight from the paper's formulas."""

import numpy as np

from mocapd.shirt.colour.colour_model import ColourModel
from mocapd.types import Bytes, Floats, Singles


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
