"""The distance between id maps of [Wang & Popovic 2009, section 4.2].

From map a to map b: over the coloured pixels of a, the mean of the squared distance to the nearest
pixel of the same colour in b; the distance is the sum of both directions. The paper leaves open what a
pixel costs whose colour the other map lacks: here MISSING, a quarter of the map's side squared, which
is more than a wrong limb usually costs and little enough that one stray pixel does not decide. It bounds
every pixel's cost, so that a colour far away is never worse than a colour that is missing. Two maps
without any colour are at distance 0; a map with and one without are at 2 MISSING.
"""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel
from mocapd.shirt.pose_database.idmap_crop_kernels import N_IDS, SIZE

Bytes = NDArray[np.uint8]
Singles = NDArray[np.float32]

MISSING = 100.0  # [px^2]


@kernel
def squared_distances(ids: Bytes, out: Singles) -> None:
    """out (N_IDS,h,w): squared distance [px^2] to the nearest pixel of each colour, at most MISSING.

    Exact, one dimension after the other: the second pass minimises over at most ten pixels each way,
    beyond which the bound holds.
    """
    h, w = ids.shape
    reach = int(np.sqrt(MISSING))
    far = np.float32(MISSING)
    for c in range(1, N_IDS):
        plane = out[c]
        for y in range(h):
            for x in range(w):
                plane[y, x] = far
    column = np.empty((h, w), np.float32)
    seen = np.zeros(N_IDS, np.bool_)
    for y in range(h):
        for x in range(w):
            seen[ids[y, x]] = True
    for c in range(1, N_IDS):
        if not seen[c]:
            continue
        plane = out[c]
        for x in range(w):
            gap = reach
            for y in range(h):
                gap = 0 if ids[y, x] == c else min(gap + 1, reach)
                column[y, x] = gap * gap
            gap = reach
            for y in range(h - 1, -1, -1):
                gap = 0 if ids[y, x] == c else min(gap + 1, reach)
                column[y, x] = min(column[y, x], np.float32(gap * gap))
        for y in range(h):
            for k in range(-reach, reach + 1):
                k2 = np.float32(k * k)
                row = column[y, max(0, k) : w + min(0, k)]
                result = plane[y, max(0, -k) : w + min(0, -k)]
                for x in range(result.shape[0]):
                    d = row[x] + k2
                    result[x] = d if d < result[x] else result[x]


@kernel
def from_packed(packed: Bytes, distances: Singles) -> float:
    """From a packed map to the one of `distances` (N_IDS, SIZE*SIZE): mean squared distance [px^2]."""
    total = np.float32(0.0)
    count = 0
    for i in range(packed.shape[0]):
        low, high = packed[i] & 15, packed[i] >> 4
        if low != 0:
            total += distances[low, 2 * i]
            count += 1
        if high != 0:
            total += distances[high, 2 * i + 1]
            count += 1
    return float(total / count) if count > 0 else -1.0


@kernel
def sort_by_colour(ids: Bytes, xs: Singles, ys: Singles, start: NDArray[np.int64]) -> None:
    """Coordinates of the coloured pixels, colour by colour: those of c at start[c] : start[c + 1]."""
    h, w = ids.shape
    for c in range(start.shape[0]):
        start[c] = 0
    for y in range(h):
        for x in range(w):
            if ids[y, x] != 0:
                start[ids[y, x] + 1] += 1
    for c in range(1, start.shape[0]):
        start[c] += start[c - 1]
    fill = start.copy()
    for y in range(h):
        for x in range(w):
            c = ids[y, x]
            if c != 0:
                xs[fill[c]], ys[fill[c]] = x, y
                fill[c] += 1


@kernel(fastmath=True)
def to_points(
    xs: Singles,
    ys: Singles,
    start: NDArray[np.int64],
    other_xs: Singles,
    other_ys: Singles,
    other_start: NDArray[np.int64],
    scratch: Singles,
) -> float:
    """From one list of pixels sorted by colour to another: mean squared distance [px^2]."""
    total = np.float32(0.0)
    for c in range(1, N_IDS):
        # slices that are indexed from 0 let the compiler run the inner loop as vectors
        x, y = xs[start[c] : start[c + 1]], ys[start[c] : start[c + 1]]
        least = scratch[: x.shape[0]]
        for i in range(least.shape[0]):
            least[i] = np.float32(MISSING)
        for k in range(other_start[c], other_start[c + 1]):
            px, py = other_xs[k], other_ys[k]
            for i in range(least.shape[0]):
                dx, dy = x[i] - px, y[i] - py
                d = dx * dx + dy * dy
                least[i] = d if d < least[i] else least[i]
        for i in range(least.shape[0]):
            total += least[i]
    count = start[N_IDS]
    return float(total / count) if count > 0 else -1.0


@kernel
def one_way_distances(
    query: Bytes,
    maps: Bytes,
    candidates: NDArray[np.int64],
    to_query: Singles,
    one_way: NDArray[np.float64],
) -> None:
    """Fill one_way (C,): from each of maps[candidates] to `query`, of which to_query (N_IDS,SIZE,SIZE) are the squared
    distances; one look-up a pixel."""
    squared_distances(query, to_query)
    table = to_query.reshape(N_IDS, SIZE * SIZE)
    is_empty = True
    for y in range(SIZE):
        for x in range(SIZE):
            is_empty &= query[y, x] == 0
    for n in range(candidates.shape[0]):
        d = from_packed(maps[candidates[n]], table)
        one_way[n] = d if d >= 0.0 else (0.0 if is_empty else MISSING)


@kernel
def nearest_in_order(
    query: Bytes,
    maps: Bytes,
    candidates: NDArray[np.int64],
    one_way: NDArray[np.float64],
    best: NDArray[np.int64],
    distance: NDArray[np.float64],
) -> None:
    """See `nearest_exact`; candidates in the order of one_way (C,), their distances to the query."""
    k = best.shape[0]
    for i in range(k):
        best[i] = -1
        distance[i] = np.inf
    xs, ys = np.empty(SIZE * SIZE, np.float32), np.empty(SIZE * SIZE, np.float32)
    other_xs, other_ys = np.empty(SIZE * SIZE, np.float32), np.empty(SIZE * SIZE, np.float32)
    start, other_start = np.empty(N_IDS + 1, np.int64), np.empty(N_IDS + 1, np.int64)
    scratch = np.empty(SIZE * SIZE, np.float32)
    unpacked = np.empty((SIZE, SIZE), np.uint8)
    flat = unpacked.reshape(-1)
    sort_by_colour(query, xs, ys, start)
    for n in range(candidates.shape[0]):
        if one_way[n] >= distance[k - 1]:
            break
        packed = maps[candidates[n]]
        for i in range(packed.shape[0]):
            flat[2 * i] = packed[i] & 15
            flat[2 * i + 1] = packed[i] >> 4
        sort_by_colour(unpacked, other_xs, other_ys, other_start)
        d = to_points(xs, ys, start, other_xs, other_ys, other_start, scratch)
        if d < 0.0:
            d = 0.0 if other_start[N_IDS] == 0 else MISSING
        d += one_way[n]
        if d < distance[k - 1]:
            i = k - 1
            while i > 0 and distance[i - 1] > d:
                distance[i], best[i] = distance[i - 1], best[i - 1]
                i -= 1
            distance[i], best[i] = d, candidates[n]
