"""The annealed particle filter of Deutscher, Blake and Reid (CVPR 2000) with the changes by Rao and Hodges."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from mocapd.types import Floats

Weigh = Callable[[Floats], Floats]  # (N,D) particles to weights (N,) in 0..1


class Selection(StrEnum):
    """Selection at the end of a layer: the heavier half, or as many drawn in proportion to their weights."""

    HEAVIEST = "heaviest"
    RANDOM = "random"


@dataclass(frozen=True, slots=True)
class AnnealingParams:
    """particles, layers: N and M of the paper. selected: share of the particles that a layer hands on. cooling: factor of the
    noise's variance from layer to layer, the share that survives, as in Deutscher 2000. smoothing: exponent of the weights
    in the top layer; layer 0 has 1. crossover: take each angle from one of two selected particles, as in Deutscher 2001."""

    particles: int = 81
    layers: int = 3
    selected: float = 0.5
    cooling: float = 0.5
    smoothing: float = 0.25
    selection: Selection = Selection.HEAVIEST
    crossover: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class SearchSpace:
    """What particles are vectors of, D numbers with limits: angles, or coordinates of `mean` + `basis` times them.

    sd (D,): of the noise of the top layer; lower, upper (A,): of the angles [rad]; mean (A,), basis (A,D): None where the
    vectors are the angles themselves.
    """

    sd: Floats
    lower: Floats
    upper: Floats
    mean: Floats | None = None
    basis: Floats | None = None

    def angles(self, vectors: Floats) -> Floats:
        """Angles (...,A) [rad] of vectors (...,D), within the limits."""
        if self.mean is not None and self.basis is not None:
            vectors = self.mean + vectors @ self.basis.T
        return np.clip(vectors, self.lower, self.upper)

    def vector(self, angles: Floats) -> Floats:
        """The vector (D,) of angles (A,)."""
        if self.mean is not None and self.basis is not None:
            return (angles - self.mean) @ self.basis
        return angles


@dataclass(frozen=True, slots=True, eq=False)
class Annealed:
    """angles (A,): the weighted mean of the bottom layer's selected particles; spread (A,): their weighted standard
    deviation; weight: of the heaviest of them."""

    angles: Floats
    spread: Floats
    weight: float


def anneal(
    angles: Floats,
    space: SearchSpace,
    weigh: Weigh,
    rng: np.random.Generator,
    params: AnnealingParams,
) -> Annealed:
    """Search from the last frame's angles (A,) through all layers of one frame; weigh takes angles (N,A)."""
    p = params
    start = space.vector(angles)
    vectors = start + rng.standard_normal((p.particles, len(start))) * space.sd
    chosen, weights = vectors, np.ones(len(vectors))
    for layer in reversed(range(p.layers)):
        if space.basis is None:
            vectors = space.angles(vectors)
        found = weigh(space.angles(vectors))
        which = _select(found ** _exponent(layer, p), rng, p)
        chosen, weights = vectors[which], found[which]
        if layer == 0:
            break
        parents = np.resize(chosen, vectors.shape)  # in turn, the heaviest once more
        if p.crossover:
            parents = _crossover(parents, rng)
        sd = space.sd * np.sqrt(p.cooling) ** (p.layers - layer)
        vectors = parents + rng.standard_normal(parents.shape) * sd
    total = float(weights.sum())
    shares = weights / total if total > 0.0 else np.full(len(weights), 1.0 / len(weights))
    poses = space.angles(chosen)
    mean = shares @ poses
    return Annealed(mean, np.sqrt(shares @ (poses - mean) ** 2), float(weights.max()))


def _exponent(layer: int, params: AnnealingParams) -> float:
    """1 at layer 0, `smoothing` at the top."""
    return float(params.smoothing ** (layer / max(params.layers - 1, 1)))


def _select(weights: Floats, rng: np.random.Generator, params: AnnealingParams) -> np.ndarray:
    """Indices of the particles that go on, the heaviest first; equal weights in the order of the particles."""
    order = np.argsort(-weights, kind="stable")
    if params.selection is Selection.HEAVIEST:
        return order[: max(1, round(params.selected * len(weights)))]
    total = weights.sum()
    if total <= 0.0:
        return order
    drawn = np.searchsorted(np.cumsum(weights) / total, rng.random(len(weights)), side="right")
    return np.minimum(drawn, len(weights) - 1)


def _crossover(parents: Floats, rng: np.random.Generator) -> Floats:
    """Each number from one of two parents."""
    mates = parents[rng.permutation(len(parents))]
    return np.where(rng.random(parents.shape) < 0.5, parents, mates)
