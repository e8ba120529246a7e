"""Mahalanobis distances as one affine map per colour, with the white balance folded in."""

from dataclasses import dataclass

import numpy as np

from mocapd.shirt.colour.colour_model import ColourModel
from mocapd.types import Floats, Singles

_RGB_FROM_BGR_BYTES = np.eye(3)[::-1] / 255.0


@dataclass(frozen=True, slots=True, eq=False)
class Whitening:
    """upper (10,3,3) and offset (10,3) float32: |upper[k] @ bgr + offset[k]| = |W I - mu_k|_Sigma_k.

    `bgr` are the pixel's own bytes 0..255. upper[k] is upper triangular: the last row depends on
    the red byte alone, so a far colour is ruled out after one multiplication.
    """

    upper: Singles
    offset: Singles


def fold(model: ColourModel, W: Floats) -> Whitening:
    """The maps of all colours of `model` for images with white balance `W` (3,3)."""
    precision_roots = np.linalg.inv(np.linalg.cholesky(model.tolerant_covariance))  # (10,3,3)
    # A rotation of the whitened space keeps lengths: QR makes the product triangular again.
    rotations, upper = np.linalg.qr(precision_roots @ W @ _RGB_FROM_BGR_BYTES)
    whitened_mean = (precision_roots @ model.mean[:, :, None])[:, :, 0]
    offset = -np.einsum("kji,kj->ki", rotations, whitened_mean)
    return Whitening(upper.astype(np.float32), offset.astype(np.float32))
