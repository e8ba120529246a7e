"""Weights of particles, and the particles that are drawn by them, of head and limbs."""

import numpy as np

from mocapd.types import Floats, Ints


def normalised_weights(log_scores: Floats) -> Floats:
    """Weights (N,) that sum to 1, of logarithms of likelihoods (N,)."""
    weights = np.exp(log_scores - log_scores.max())
    out: Floats = weights / weights.sum()
    return out


def resample(weights: Floats, start: float, n: int) -> Ints:
    """Systematic resampling: (n,) indices into weights (N,), which sum to 1; start in 0..1, the only random number.

    Index k comes floor(n w) or ceil(n w) times, n w times on average. [Kitagawa 1996; Douc and Cappé 2005]
    """
    places = (np.arange(n) + start) / n
    chosen = np.searchsorted(np.cumsum(weights), places, side="right")
    return np.minimum(chosen, len(weights) - 1)
