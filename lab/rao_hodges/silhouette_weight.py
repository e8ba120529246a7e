"""Weights of a limb's particles by silhouettes, which the paper compares its points in space with."""

from collections.abc import Sequence

import numpy as np

from mocapd.published.rao_hodges.limb_chain import LimbChain
from mocapd.published.rao_hodges.limb_weight import PosedChain, places_within
from mocapd.types import Bytes, Camera, Floats
from mocapd.vision.hull.hull_kernels import sum_at_points
from mocapd.vision.hull.picture_stack import StackProjections, stack_pictures, stack_projections


class SilhouetteWeight:
    """The weight of Deutscher 2000 without edges: which share of the model falls on the silhouettes of all cameras."""

    def __init__(self, cameras: Sequence[Camera], silhouettes: Sequence[Bytes]) -> None:
        """silhouettes (h,w): 0 is background; each of the size of its camera's work picture."""
        sizes = [(mask.shape[1], mask.shape[0]) for mask in silhouettes]
        self._projections: StackProjections = stack_projections(cameras, sizes)
        self._maps = np.asarray(
            stack_pictures([(mask > 0).astype(np.float32) for mask in silhouettes]), np.float32
        )

    def __call__(self, chain: LimbChain, pose: PosedChain) -> Floats:
        """(N,) of particles."""
        places = places_within(chain, pose)
        flat = np.ascontiguousarray(places.reshape(-1, 3))
        sums, n_views = np.empty(len(flat), np.float32), np.empty(len(flat), np.uint8)
        sum_at_points(flat, self._maps, *self._projections, 0.0, sums, n_views)
        weight: Floats = sums.reshape(len(places), -1).mean(axis=1).astype(float) / len(self._maps)
        return weight
