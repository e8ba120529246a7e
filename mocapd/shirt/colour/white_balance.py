"""White balance: the 3x3 matrix from a camera's RGB to the colour model's RGB (paper §5.1, step 5)."""

import numpy as np

from mocapd.shirt.colour.colour_model import ColourModel
from mocapd.types import Bytes, Floats

DEFAULT_RIDGE = 1e-3
REFERENCE_DISTANCE = 0.5
REFERENCE_CAPACITY = 16
_MEAN_SHADING = 0.3
_MEAN_NOISE = 0.04


def solve_white_balance(
    image_means: Floats,
    model_means: Floats,
    weights: Floats,
    prior: Floats | None = None,
    ridge: float = DEFAULT_RIDGE,
    precision: Floats | None = None,
) -> Floats:
    """W (3,3) minimising sum_k w_k |W image_k - model_k|^2_precision_k + ridge |W - prior|_F^2.

    image_means, model_means (K,3) RGB 0..1; weights (K,) >= 0, such as pixel counts; only their
    ratios matter, 0 leaves a colour out. `ridge` has the unit of a squared colour: with ten
    colours in view it hardly moves W, with one or two it keeps W at the prior in the directions
    they do not span. `prior` is the previous W; without one, the best diagonal matrix.
    `precision` (K,3,3), as of `shade_precision`, says in which directions a colour is to be
    trusted; None trusts all alike, which with ridge = 0 is the paper's equation. A singular
    system gets the solution next to the prior.
    """
    total = weights.sum()
    share = weights / total if total > 0 else np.zeros_like(weights)
    if prior is None:
        prior = _diagonal(image_means, model_means, share)
    if precision is None:
        precision = np.ones((len(weights), 1, 1)) * np.eye(3)
    # Normal equations of vec(W - prior), row by row: what is not observed stays at the prior.
    trust = share[:, None, None] * precision
    moments = np.einsum("kac,kb,kd->abcd", trust, image_means, image_means).reshape(9, 9)
    residual = model_means - image_means @ prior.T
    right = np.einsum("kac,kc,kb->ab", trust, residual, image_means).reshape(9)
    step = np.linalg.lstsq(moments + ridge * np.eye(9), right, rcond=1e-9)[0]
    W: Floats = prior + step.reshape(3, 3)
    return W


def shade_precision(model: ColourModel) -> Floats:
    """Precisions (10,3,3), 1 at most, that trust the hue of a patch's mean more than its brightness.

    A patch may lie in shade as a whole; W is to explain the colour of the light, not the folds.
    """
    tolerant = model.tolerating(_MEAN_SHADING, _MEAN_NOISE).tolerant_covariance
    return np.asarray(np.linalg.inv(tolerant) * _MEAN_NOISE**2, dtype=np.float64)


def apply_white_balance(pixels: Bytes, W: Floats) -> Bytes:
    """A picture (h,w,3) BGR of the camera in the light of the model."""
    rgb = pixels[..., ::-1].astype(float) @ W.T
    return np.ascontiguousarray(np.clip(np.rint(rgb), 0.0, 255.0)[..., ::-1]).astype(np.uint8)


def frobenius_distance(first: Floats, second: Floats) -> float:
    """|first - second|_F."""
    return float(np.linalg.norm(first - second))


def remember_illumination(
    references: tuple[Floats, ...],
    W: Floats,
    min_distance: float = REFERENCE_DISTANCE,
) -> tuple[Floats, ...]:
    """The reference illuminations with W added, if it is farther than `min_distance` from each.

    When full, the oldest after the first leaves: the first is the user's own scribble, and the
    cost of trying them all must not grow with running time.
    """
    if any(frobenius_distance(W, other) <= min_distance for other in references):
        return references
    if len(references) >= REFERENCE_CAPACITY:
        references = references[:1] + references[2:]
    return (*references, W)


def _diagonal(image_means: Floats, model_means: Floats, share: Floats) -> Floats:
    power = (share[:, None] * image_means**2).sum(axis=0)
    overlap = (share[:, None] * image_means * model_means).sum(axis=0)
    return np.diag(np.where(power > 1e-6, overlap / np.maximum(power, 1e-6), 1.0))
