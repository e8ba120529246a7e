"""What the shirt's ten colours look like to one camera now: learned means and covariances over a prior from W.

The colour model (paper section 5.1) lives in white-balanced RGB; W maps the camera's colours to it.
Within a light, each colour is followed in the camera's own space, because a 3x3 matrix cannot
follow shadow, interreflection and the camera's response. A colour out of view keeps its prior from W.
"""

from dataclasses import dataclass, replace

import numpy as np

from mocapd.types import Floats, Singles

N = 10
_BGR = np.array([2, 1, 0])
_VISIBLE_PX = 12.0  # least pixels of a visible colour
_PRIOR_PX = 60.0  # weight of the prior against learned pixels


@dataclass(frozen=True, slots=True, eq=False)
class ShirtAppearance:
    """W (3,3), model_from_camera on RGB 0..1; sums (N,4): decayed count and BGR sums of each colour."""

    W: Floats
    sums: Floats


def fresh(W: Floats) -> ShirtAppearance:
    """Nothing learned yet under this white balance."""
    return ShirtAppearance(W, np.zeros((N, 4)))


def learn(
    appearance: ShirtAppearance, sums: Floats, dt_s: float, memory_s: float
) -> ShirtAppearance:
    """Blend in the statistics of a new frame; an invisible colour keeps its statistics."""
    keep = np.exp(-dt_s / memory_s)
    visible = sums[:, :1] >= _VISIBLE_PX
    # each frame weighs at most so many pixels that an old memory of few can be outvoted
    blended = np.where(visible, keep * appearance.sums + (1.0 - keep) * sums, appearance.sums)
    return replace(appearance, sums=blended)


def gaussians(
    appearance: ShirtAppearance,
    model_mean: Floats,
    model_covariance: Floats,
    cloth_sd: float,
    noise_sd: float,
    shading_sd: float,
) -> tuple[Floats, Floats]:
    """Means (N,3) and covariances (N,3,3) in the camera's BGR 0..1: the model's colours behind W, and the measured ones."""
    # the mean is the camera's own once the colour is well visible; a spread learned from what was
    # classified would grow by itself until it covers skin and trousers, so the model's stays
    # in numpy: as a kernel it took three seconds to compile, and saved 0.1 ms a frame
    inverse = np.linalg.inv(appearance.W)[::-1]  # rows to b, g, r
    n = appearance.sums[:, :1]
    trust = n / (n + _PRIOR_PX)
    expected = model_mean @ inverse.T
    measured = np.divide(appearance.sums[:, 1:], n, out=expected.copy(), where=n > 0.0)
    mean = trust * measured + (1.0 - trust) * expected
    eye = np.eye(3)
    covariance = inverse @ (model_covariance + cloth_sd**2 * eye) @ inverse.T + noise_sd**2 * eye
    covariance += shading_sd**2 * mean[:, :, None] * mean[:, None, :]
    return mean, covariance


def whitening(mean: Floats, covariance: Floats) -> Singles:
    """affine (10,3,4) for `classify`: |A (b,g,r,1)| is the Mahalanobis distance of a BGR 0..255 pixel."""
    A = np.linalg.inv(np.linalg.cholesky(covariance))
    out = np.empty((len(mean), 3, 4), np.float32)
    out[:, :, :3] = A / 255.0
    out[:, :, 3] = -(A @ mean[:, :, None])[:, :, 0]
    return out


def white_balance(appearance: ShirtAppearance, model_mean: Floats, ridge: float = 0.02) -> Floats:
    """W (3,3) from the learned means of the visible colours (paper section 5.2, step 5), pulled to the last W."""
    n = appearance.sums[:, 0]
    visible = n >= _VISIBLE_PX
    if visible.sum() < 3:
        return appearance.W
    image = (appearance.sums[visible, 1:4] / n[visible, None])[:, _BGR]
    # normal equations: three unknowns a row, and the ridge keeps them well conditioned
    weighted = (np.minimum(n[visible], 400.0) / 400.0)[:, None] * image
    moments = weighted.T @ image + ridge * np.eye(3)
    target = weighted.T @ model_mean[visible] + ridge * appearance.W.T
    W: Floats = np.asarray(np.linalg.solve(moments, target)).T
    return W


def adapt_to_light(
    appearance: ShirtAppearance, observed: Floats, model_mean: Floats
) -> ShirtAppearance:
    """The appearance in a new light, from the pixels at the expected place of each colour.

    One matrix M maps the reference colours to the observed ones (10,4 statistics of the predicted
    patches, classified or not): least squares drawn towards a plain change of brightness, so that
    few colours suffice.
    """
    inverse = np.linalg.inv(appearance.W)
    reference = (model_mean @ inverse.T)[:, _BGR]
    n = appearance.sums[:, 0]
    learned = n >= _VISIBLE_PX
    reference[learned] = appearance.sums[learned, 1:4] / n[learned, None]
    visible = observed[:, 0] >= _VISIBLE_PX
    if visible.sum() < 2:
        return appearance
    now = observed[visible, 1:4] / observed[visible, :1]
    gain = float(np.median(now.sum(axis=1) / reference[visible].sum(axis=1)))
    weight = np.sqrt(np.minimum(observed[visible, :1], 200.0) / 200.0)
    ridge = 0.15
    A = np.concatenate([weight * reference[visible], ridge * np.eye(3)])
    b = np.concatenate([weight * now, ridge * gain * np.eye(3)])
    M = np.linalg.lstsq(A, b, rcond=None)[0].T
    stretch = np.linalg.svd(M, compute_uv=False)
    if np.linalg.det(M) <= 0.0 or stretch[0] > 5.0 or stretch[-1] < 0.1:
        return appearance  # no lamp does that: the pose is wrong, not the light
    W = appearance.W @ np.linalg.inv(M[::-1, ::-1])
    sums = appearance.sums.copy()
    sums[:, 1:4] = sums[:, 1:4] @ M.T
    return ShirtAppearance(W, sums)
