"""Colours of the body's regions as histograms, and which region a pixel belongs to.

How far each pixel is from each region of the drawn body is found for all regions at once, by the two passes of the chamfer
distance (Borgefors 1986), in OpenCV's weights. Vector instructions take the regions of a pixel side by side, so that all take
less than half of the time of a distance transform for each.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel
from mocapd.vision.foreground_kernels import SHADOW

Singles = NDArray[np.float32]
N_CLASSES = 8  # the seven regions, and 0: none of them
BITS = 4  # of each channel
DISTANCE_GRID_PX = 2  # no colour depends on a pixel's distance
N_BINS = 1 << 3 * BITS
LANES = 8  # places of a pixel, of which the regions 1.. take the first ones
_BESIDE_PX, _ACROSS_PX = 0.955, 1.3693
_FAR_PX = 1e3


class RegionCosts(NamedTuple):
    """What a pixel's explanations cost, as logarithms of likelihoods.

    A region pays per_px for each pixel of distance, up to longest_px; beyond reach_px from all regions nothing is. What is
    no region pays other_cost, and other_per_px for each pixel that it is away from the body, up to other_px: limbs move
    there. What may be a shadow pays at most shadow_costs (a sure one, a likely one), and shadow_per_px for each pixel by
    which it is nearer to the body than shadow_px. person_weight of the network's odds, up to person_most, is spared by
    all regions, and paid where negative.
    """

    per_px: float
    longest_px: float
    reach_px: float
    other_cost: float
    other_per_px: float
    other_px: float
    shadow_costs: tuple[float, float]
    shadow_per_px: float
    shadow_px: float
    person_weight: float
    person_most: float


@kernel(inline="always")
def colour_bin(picture: NDArray[np.uint8], y: int, x: int) -> int:
    """The histogram's bin of a pixel."""
    shift = 8 - BITS
    b, g, r = picture[y, x, 0] >> shift, picture[y, x, 1] >> shift, picture[y, x, 2] >> shift
    return (int(b) << 2 * BITS) | (int(g) << BITS) | int(r)


@kernel
def count_colours(
    picture: NDArray[np.uint8],
    classes: NDArray[np.uint8],
    nothing: int,
    rate: float,
    counts: Singles,
) -> None:
    """Add `rate` to counts (8,4096) for each pixel of the picture (h,w,3), by its class (h,w); `nothing`: a class that is not
    counted."""
    h, w = classes.shape
    for y in range(h):
        for x in range(w):
            k = classes[y, x]
            if k != nothing:
                counts[k, colour_bin(picture, y, x)] += np.float32(rate)


@kernel
def log_table(counts: Singles, least: float, scratch: Singles, out: Singles) -> None:
    """out (8,4096): minus the logarithm of each class's share of its own pixels, smoothed over neighbouring bins (1 2 1)
    in all three channels. scratch (4096,); least: the share of a colour that was never seen."""
    n = 1 << BITS
    quarter, half = np.float32(0.25), np.float32(0.5)
    never = -np.log(np.float32(0.0) + np.float32(least))
    for k in range(counts.shape[0]):
        table = out[k]
        total, is_empty = np.float32(1e-3), True
        for i in range(N_BINS):
            total += counts[k, i]
            is_empty &= counts[k, i] == 0.0
        if is_empty:
            for i in range(N_BINS):
                table[i] = never
            continue
        for channel in range(3):
            step = 1 << (BITS * channel)  # from a bin to its neighbour
            bins = counts[k] if channel == 0 else table if channel == 1 else scratch
            smooth = scratch if channel == 1 else table
            for i in range(step, N_BINS - step):
                smooth[i] = quarter * (bins[i - step] + bins[i + step]) + half * bins[i]
            # the first and the last level are their own neighbours
            for first in range(0, N_BINS, n * step):
                last = first + (n - 1) * step
                for i in range(step):
                    low, high = bins[first + i], bins[last + i]
                    smooth[first + i] = quarter * (low + bins[first + step + i]) + half * low
                    smooth[last + i] = quarter * (bins[last - step + i] + high) + half * high
        for i in range(N_BINS):
            # most colours are seen nowhere, and a logarithm takes a while
            share = table[i] / total + np.float32(least)
            table[i] = never if table[i] == 0.0 else -np.log(share)


@kernel
def classify_regions(
    picture: NDArray[np.uint8],
    before: NDArray[np.uint8],
    distance_px: Singles,
    table: Singles,
    on_floor: NDArray[np.uint8],
    person_odds: Singles,
    costs: RegionCosts,
    out: NDArray[np.uint8],
) -> None:
    """out (h,w): the region whose colour and place explain each pixel best, 0 for none.

    before (h,w): as of `stands_before`; distance_px: of `region_distances`; table (8,4096): `log_table`; on_floor (h,w):
    where it is 0, only sure shadows are shadows; person_odds (h,w): log-odds of the network.
    """
    per_px, longest_px, reach_px, other_cost, other_per_px, other_px = costs[:6]
    shadow_costs, shadow_per_px, shadow_px, person_weight, person_most = costs[6:]
    h, w = before.shape
    for y in range(h):
        for x in range(w):
            out[y, x] = 0
            if before[y, x] == 0:
                continue
            i = colour_bin(picture, y, x)
            nearest = np.float32(1e9)
            best, found = np.float32(1e9), 0
            for k in range(1, N_CLASSES):
                d = distance_px[y // DISTANCE_GRID_PX, x // DISTANCE_GRID_PX, k - 1]
                nearest = min(nearest, d)
                cost = table[k, i] + np.float32(per_px) * min(d, np.float32(longest_px))
                if cost < best:
                    best, found = cost, k
            if nearest > reach_px:
                continue
            other = (
                table[0, i]
                + np.float32(other_cost)
                + np.float32(other_per_px) * min(nearest, np.float32(other_px))
            )
            if before[y, x] == SHADOW or (before[y, x] > SHADOW and on_floor[y, x] != 0):
                within = np.float32(shadow_per_px) * max(
                    np.float32(shadow_px) - nearest, np.float32(0.0)
                )
                other = min(other, np.float32(shadow_costs[before[y, x] - SHADOW]) + within)
            person = np.float32(person_weight) * person_odds[y, x]
            person = min(max(person, -np.float32(person_most)), np.float32(person_most))
            if best < other + person:
                out[y, x] = found


@kernel
def chamfer_distances(drawn: NDArray[np.uint8], grid_px: float, out: Singles) -> None:
    """out (h+2,w+2,8): from each pixel of a grid of grid_px to where each of the regions is drawn (h,w) on it [px]; large
    where one is not, and in the border."""
    h, w = drawn.shape
    n = LANES * (w + 2)
    beside, across = np.float32(grid_px * _BESIDE_PX), np.float32(grid_px * _ACROSS_PX)
    rows = out.reshape(h + 2, n)
    rows[:] = np.float32(_FAR_PX)
    for y in range(h):
        row = rows[y + 1]
        _from_next_row(rows[y], row, beside, across)
        for x in range(w):
            k = drawn[y, x]
            if k > 0:
                row[LANES * (x + 1) + k - 1] = 0.0
        for i in range(LANES, n - LANES):
            row[i] = min(row[i], row[i - LANES] + beside)
    for y in range(h - 1, -1, -1):
        row = rows[y + 1]
        _from_next_row(rows[y + 2], row, beside, across)
        for i in range(n - LANES - 1, LANES - 1, -1):
            row[i] = min(row[i], row[i + LANES] + beside)


@kernel(inline="always")
def _from_next_row(other: Singles, row: Singles, beside: np.float32, across: np.float32) -> None:
    """Lessen a row (8 w,) by what is nearer by way of the row above or below. In slices, as with offsets in the index the
    compiler finds no vector instructions."""
    left, middle, right = other[: -2 * LANES], other[LANES:-LANES], other[2 * LANES :]
    mine = row[LANES:-LANES]
    for i in range(mine.shape[0]):
        nearest = min(left[i], right[i]) + across
        nearest = min(nearest, middle[i] + beside)
        mine[i] = min(mine[i], nearest)
