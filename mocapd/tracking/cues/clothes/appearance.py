"""The appearance of the wearer in one camera: colour histograms of each region and of other foreground.

Hecht et al. (2009, III.E) learn ten colours along each limb over the first frames and then fix them. Here the histograms
keep adapting slowly, since light changes and people turn; other foreground is a class of its own.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from mocapd.body.arrays import plain
from mocapd.tracking.cues.clothes.appearance_kernels import (
    BITS,
    DISTANCE_GRID_PX,
    LANES,
    N_BINS,
    N_CLASSES,
    RegionCosts,
    chamfer_distances,
    classify_regions,
    count_colours,
    log_table,
)
from mocapd.tracking.cues.clothes.regions import Band, Region
from mocapd.types import Bytes, Floats, Singles
from mocapd.vision.foreground_kernels import SHADOW

_UNCOUNTED = 255
_CORE = np.ones((3, 3), np.uint8)  # a drawn region's inside: its edge may be off by a pixel
# what is farther from the drawn body than half of this is not the body
_BESIDE = np.ones((7, 7), np.uint8)


@dataclass(frozen=True, slots=True)
class AppearanceParams:
    """How colours are learned, and what they decide."""

    keep: float = 0.97  # share of what was counted that such a frame leaves
    share: float = 0.03  # of a pixel that it adds
    new_light: float = 0.3  # share of what was counted that is left when a lamp goes on or off
    least_share: float = 2e-5  # of a colour that a region never had
    per_px: float = 0.25  # logarithm of a likelihood, by work pixel from where a region is expected
    longest_px: float = 40.0
    reach_px: float = 26.0  # beyond, nothing belongs to the body
    other_cost: float = 1.0  # of being none of the body
    other_per_px: float = 0.5
    other_px: float = 8.0
    shadow_costs: tuple[float, float] = (1.5, 4.0)  # of a sure and a likely shadow, to be one
    shadow_per_px: float = 0.75
    shadow_px: float = 4.0  # from the expected body: nearer, cloth is likelier
    # of the network's odds that a pixel is the person, and the largest cost that they make or spare
    person_weight: float = 0.7
    person_most: float = 3.0
    least_other_px: float = 50.0  # of other foreground before it is a class


class Appearance:
    """Histograms of one camera and what is computed from them; the only state is theirs."""

    def __init__(self, params: AppearanceParams) -> None:
        self._params = params
        self._counts = np.zeros((1 + len(Region) + len(Band), N_BINS), np.float32)
        self._table = np.zeros_like(self._counts)
        self._scratch = np.empty(N_BINS, np.float32)
        self.reset()

    def reset(self) -> None:
        """Clears the histograms."""
        self._counts[:] = 0.0
        self._refresh()

    def relight(self, gain: Floats) -> None:
        """Moves the histograms to a light of this gain by channel (3,), with less weight against new observations."""
        n = 1 << BITS
        middles = np.arange(n) + 0.5
        to = [np.clip(middles * channel, 0, n - 1).astype(np.int64) for channel in gain]
        there = (to[0][:, None, None] << 2 * BITS) | (to[1][:, None] << BITS) | to[2]
        old = self._counts.copy()
        self._counts[:] = 0.0
        for counted, before in zip(self._counts, old, strict=True):
            np.add.at(counted, there.ravel(), self._params.new_light * before)
        self._refresh()

    def overlap(self, one: int, other: int) -> float:
        """Overlap of two regions' colour histograms, 0..1; 1 if one of them is empty."""
        shares = []
        for k in (one, other):
            share = np.exp(-self._table[k]) - self._params.least_share
            if self._counts[k].sum() <= 0.0:
                return 1.0
            shares.append(share / share.sum())
        return float(np.minimum(*shares).sum())

    def merge_regions(self, merge: Sequence[int]) -> None:
        """Adds the histogram of each merged region to that of its target."""
        for k, other in enumerate(merge):
            if other != k:
                self._counts[other] += self._counts[k]
                self._counts[k] = 0.0
        self._refresh()

    def learn(self, picture: Bytes, drawn: Bytes, before: Bytes, ids: Bytes | None = None) -> None:
        """Adds the colours of a picture (h,w,3) where the body is rendered (h,w) and is foreground.

        ids (h,w): the classified regions; pixels where they differ from the rendered ones are left out, since the pose may
        be wrong there. None: the first picture, which has full weight.
        """
        classes = np.full(drawn.shape, _UNCOUNTED, np.uint8)
        is_foreground = before > 0
        classes[(cv2.dilate(drawn, _BESIDE) == 0) & is_foreground] = 0
        lowest, highest = cv2.erode(drawn, _CORE), cv2.dilate(drawn, _CORE)
        core = (lowest == highest) & (drawn > 0) & is_foreground
        core &= before < SHADOW if ids is None else ids == drawn
        classes[core] = drawn[core]
        p = self._params
        if ids is not None:
            self._counts *= p.keep
        count_colours(picture, classes, _UNCOUNTED, 1.0 if ids is None else p.share, self._counts)
        self._refresh()

    def classify(
        self,
        picture: Bytes,
        before: Bytes,
        distance_px: Singles,
        on_floor: Bytes,
        person_odds: Singles,
    ) -> Bytes:
        """The region (h,w) of each pixel of a picture (h,w,3); see `classify_regions`."""
        p = self._params
        ids = np.empty(before.shape, np.uint8)
        costs = RegionCosts(
            p.per_px, p.longest_px, p.reach_px, p.other_cost if self._knows_others else 1e6, p.other_per_px, p.other_px,
            p.shadow_costs, p.shadow_per_px, p.shadow_px, p.person_weight, p.person_most,
        )  # fmt: skip
        classify_regions(
            picture, before, distance_px, self._table, on_floor, person_odds, plain(costs), ids
        )
        return ids

    def _refresh(self) -> None:
        self.is_learned = bool(self._counts[1:].any())
        self._knows_others = bool(self._counts[0].sum() > self._params.least_other_px)
        # bands are counted only until they are joined
        n = len(self._counts) if self._counts[N_CLASSES:].any() else N_CLASSES
        log_table(self._counts[:n], self._params.least_share, self._scratch, self._table[:n])


def region_distances(drawn: Bytes) -> Singles:
    """Distances ((h+1)//2,(w+1)//2,8) [px] from every second pixel each way to where each region 1.. is drawn (h,w); large
    where it is not."""
    small = np.ascontiguousarray(drawn[::DISTANCE_GRID_PX, ::DISTANCE_GRID_PX])
    h, w = small.shape
    out = np.empty((h + 2, w + 2, LANES), np.float32)
    chamfer_distances(small, float(DISTANCE_GRID_PX), out)
    return out[1:-1, 1:-1]
