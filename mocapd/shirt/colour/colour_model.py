"""The shirt's colours: one Gaussian in RGB per colour (paper §5.1); and the Mahalanobis distances to
them as one affine map per colour, with the white balance folded in."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mocapd.errors import ConfigError
from mocapd.shirt.colour.strokes import COLOURS, stroke_colours
from mocapd.types import Bytes, Floats, Singles

MIN_PIXELS = 30
# Camera noise and JPEG loss keep a colour from being sharper than this, however even the strokes.
MIN_STANDARD_DEVIATION = 0.02
SHADING_SIGMA = 0.25
NOISE_SIGMA = 0.04
_RGB_FROM_BGR_BYTES = np.eye(3)[::-1] / 255.0


@dataclass(frozen=True, slots=True, eq=False)
class ColourModel:
    """Ten Gaussians N(mean, covariance) in white-balanced RGB, 0..1; colour id k is row k - 1.

    names (10,); mean (10,3); covariance (10,3,3), symmetric positive definite; `version`: the
    shirt it was made from. The classifier sees `tolerant_covariance`, which adds two spreads that
    five even images do not show, both 0 in the paper's model: `shading_sigma`, the standard
    deviation of a fold's brightness relative to the mean, and `noise_sigma`, that of every
    channel (sensor noise, compression, what a 3x3 white balance cannot express).
    """

    names: tuple[str, ...]
    mean: Floats
    covariance: Floats
    version: str
    shading_sigma: float = 0.0
    noise_sigma: float = 0.0

    @property
    def tolerant_covariance(self) -> Floats:
        """(10,3,3): covariance + shading_sigma^2 mean mean^T + noise_sigma^2 I.

        Shade scales all three channels by about one factor, so cloth in a fold moves along the
        line from its colour to black.
        """
        towards_black = self.mean[:, :, None] * self.mean[:, None, :]
        tolerant: Floats = (
            self.covariance
            + self.shading_sigma**2 * towards_black
            + self.noise_sigma**2 * np.eye(3)
        )
        return tolerant

    def tolerating(
        self, shading_sigma: float = SHADING_SIGMA, noise_sigma: float = NOISE_SIGMA
    ) -> "ColourModel":
        """The same colours with other tolerances; (0, 0) gives the paper's model back.

        Ellipsoids grow, so thresholds shrink: with the defaults T = 1.7 lets in as much background
        as T = 3 without, and finds half as many shirt pixels again.
        """
        return replace(self, shading_sigma=shading_sigma, noise_sigma=noise_sigma)


def fit_colour_model(
    images: Sequence[Bytes],
    strokes: Sequence[Bytes],
    names: tuple[str, ...],
    version: str = "standard-v1",
) -> ColourModel:
    """The model from white-balanced images (h,w,3) uint8 BGR and strokes (h,w) uint8 on them.

    Raises ConfigError that names each colour with too few labelled pixels.
    """
    if len(images) != len(strokes) or len(names) != COLOURS:
        raise ConfigError(
            f"{len(images)} images, {len(strokes)} stroke images, {len(names)} colour names",
            "colour model",
            f"give one stroke image per image and {COLOURS} names",
        )
    labelled = [
        stroke_colours(image, stroke) for image, stroke in zip(images, strokes, strict=True)
    ]
    values = [np.concatenate([part[k] for part in labelled]) for k in range(COLOURS)]
    missing = [
        f"{names[k]} (id {k + 1}: {len(values[k])} pixels)"
        for k in range(COLOURS)
        if len(values[k]) < MIN_PIXELS
    ]
    if missing:
        raise ConfigError(
            f"too little is labelled of: {', '.join(missing)}",
            "colour model",
            f"scribble at least {MIN_PIXELS} pixels on each of the {COLOURS} colours",
        )
    return ColourModel(
        names=names,
        mean=np.array([value.mean(axis=0) for value in values]),
        covariance=np.array([_floor_eigenvalues(np.cov(value.T)) for value in values]),
        version=version,
    )


def _floor_eigenvalues(covariance: Floats) -> Floats:
    eigenvalues, vectors = np.linalg.eigh(covariance)
    floored: Floats = (vectors * np.maximum(eigenvalues, MIN_STANDARD_DEVIATION**2)) @ vectors.T
    return floored


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
