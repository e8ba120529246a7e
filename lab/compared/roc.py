"""Counts of right and wrong colours as a classifier's threshold varies (paper Fig. 6)."""

from dataclasses import dataclass

import numpy as np

from mocapd.published.wang2011.classify_kernels import classify
from mocapd.shirt.colour.colour_model import Whitening
from mocapd.shirt.standard_shirt import standard_shirt
from mocapd.types import Bytes, Floats, Singles

Roi = tuple[int, int, int, int]  # x0, y0, x1, y1

ALONE_THRESHOLDS = np.geomspace(
    0.4, 16.0, 28
)  # of step 1 [standard deviations]; the paper's T is 3
PRIOR_THRESHOLDS = np.geomspace(0.5, 20.0, 28)  # of step 3; the paper's T is 5
MIXED = 255  # label of a work pixel that shows more than one thing
_NO_MASK, _NO_MASK_SHIFT = np.ones((1, 1), np.uint8), 31


@dataclass(frozen=True, slots=True, eq=False)
class Counts:
    """Work pixels at N thresholds: `right` (N,) on the shirt got their own colour, `wrong` (N,) got one
    that is not theirs; of so many on the `shirt`, and so many `looked_at` in all."""

    right: Floats
    wrong: Floats
    shirt: float
    looked_at: float

    @property
    def correct(self) -> Floats:
        """Share (N,) of the shirt that is classified correctly."""
        return self.right / max(self.shirt, 1.0)

    @property
    def false(self) -> Floats:
        """Share (N,) of what was looked at that is given a colour it has not."""
        return self.wrong / max(self.looked_at, 1.0)

    def __add__(self, other: "Counts") -> "Counts":
        return Counts(
            self.right + other.right,
            self.wrong + other.wrong,
            self.shirt + other.shirt,
            self.looked_at + other.looked_at,
        )


@dataclass(frozen=True, slots=True, eq=False)
class Roc:
    """Step 1 and step 3 over their thresholds, and the tracker's own classification as it ran."""

    alone: Counts
    assisted: Counts
    tracker: Counts

    def __add__(self, other: "Roc") -> "Roc":
        return Roc(
            self.alone + other.alone, self.assisted + other.assisted, self.tracker + other.tracker
        )


def no_roc() -> Roc:
    """Nothing counted yet."""
    return Roc(*(_no_counts(n) for n in (len(ALONE_THRESHOLDS), len(PRIOR_THRESHOLDS), 1)))


def colour_truth(label: Bytes, roi_px: Roi, factor: int) -> Bytes:
    """Colours (h,w) of blocks of factor x factor pixels from patch labels: 0 not shirt, 1..10, or MIXED.

    roi_px: the region in pixels, of which whole blocks are used.
    """
    x0, y0, x1, y1 = roi_px
    h, w = (y1 - y0) // factor, (x1 - x0) // factor
    colours = standard_shirt().colour_of_patch[label[y0 : y0 + h * factor, x0 : x0 + w * factor]]
    blocks = colours.reshape(h, factor, w, factor)
    lowest, highest = blocks.min(axis=(1, 3)), blocks.max(axis=(1, 3))
    truth: Bytes = np.where(lowest == highest, lowest, MIXED).astype(np.uint8)
    return truth


def count(truth: Bytes, ids: list[Bytes]) -> Counts:
    """Hold classifications (h,w), one per threshold, against the truth (h,w)."""
    known = truth != MIXED
    right = np.array([((one == truth) & (one > 0)).sum() for one in ids], dtype=float)
    given = np.array([((one > 0) & known).sum() for one in ids], dtype=float)
    shirt = float((known & (truth > 0)).sum())
    return Counts(right, given - right, shirt, float(known.sum()))


def sweep_alone(truth: Bytes, picture: Bytes, roi: Roi, whitening: Whitening) -> Counts:
    """Step 1, the Gaussians alone, over the region of a work picture (H,W,3)."""
    nowhere_far = np.zeros((len(whitening.upper), *truth.shape), np.float32)
    return sweep_assisted(truth, picture, roi, whitening, nowhere_far, 0.0, ALONE_THRESHOLDS)


def sweep_assisted(
    truth: Bytes,
    picture: Bytes,
    roi: Roi,
    whitening: Whitening,
    distance_px: Singles,
    prior_per_px: float,
    thresholds: Floats = PRIOR_THRESHOLDS,
) -> Counts:
    """Step 3: the same with the cost C d; distance_px (10,h,w) to the colours of the rendered pose."""
    ids = [np.empty(truth.shape, np.uint8) for _ in thresholds]
    for threshold, out in zip(thresholds, ids, strict=True):
        classify(
            picture, _NO_MASK, _NO_MASK_SHIFT, whitening.upper, whitening.offset, distance_px, prior_per_px,
            float(threshold), roi[0], roi[1], 1, out,
        )  # fmt: skip
    return count(truth, ids)


def correct_at(counts: Counts, false_rate: float) -> float:
    """The share classified correctly where the curve has this rate of false positives; NaN beyond it."""
    order = np.argsort(counts.false, kind="stable")
    found = np.interp(
        false_rate, counts.false[order], counts.correct[order], left=np.nan, right=np.nan
    )
    return float(found)


def _no_counts(n: int) -> Counts:
    return Counts(np.zeros(n), np.zeros(n), 0.0, 0.0)
