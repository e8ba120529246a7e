"""Pixels spread evenly over every region of every part of a drawn body."""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel

_IDS = 16  # as `surface_labels.MAX_LABELS`
N_PARTS = 16  # of the body, fewer than that
N_GROUPS = N_PARTS * _IDS


@kernel
def _group(
    ids: NDArray[np.uint8],
    triangle_at: NDArray[np.int32],
    part: NDArray[np.uint8],
    y: int,
    x: int,
    edge: int,
) -> int:
    """Of a pixel that is drawn and so are those `edge` beside it each way; else -1."""
    if (
        ids[y, x] == 0
        or ids[y - edge, x] == 0
        or ids[y + edge, x] == 0
        or ids[y, x - edge] == 0
        or ids[y, x + edge] == 0
    ):
        return -1
    return int(part[triangle_at[y, x]]) * _IDS + int(ids[y, x])


@kernel
def spread_over_groups(
    ids: NDArray[np.uint8],
    triangle_at: NDArray[np.int32],
    part: NDArray[np.uint8],
    edge: int,
    points: NDArray[np.int64],
    turn: int,
    out: NDArray[np.int64],
) -> int:
    """Fill out (N,2) with rows and columns of pixels of ids (h,w), group after group, of each at most the points (16,) of its
    part and evenly over it; how many there are.

    A group is an id on a part, part (T,) of the triangles in triangle_at (h,w). Only pixels from whose place the body goes
    on for `edge` each way; turn: a running number, by which others are taken.
    """
    h, w = ids.shape
    count = np.zeros(N_GROUPS, np.int64)
    for y in range(edge, h - edge):
        for x in range(edge, w - edge):
            group = _group(ids, triangle_at, part, y, x, edge)
            if group >= 0:
                count[group] += 1
    step, first = np.empty(N_GROUPS, np.int64), np.empty(N_GROUPS, np.int64)
    place, end = np.empty(N_GROUPS, np.int64), np.empty(N_GROUPS, np.int64)
    total = 0
    for group in range(N_GROUPS):
        most = points[group // _IDS]
        step[group] = max(count[group] // most, 1)
        first[group] = turn % step[group]
        place[group] = total
        left = count[group] - first[group]
        total += min((left + step[group] - 1) // step[group], most) if left > 0 else 0
        end[group] = total
    count[:] = 0
    for y in range(edge, h - edge):
        for x in range(edge, w - edge):
            group = _group(ids, triangle_at, part, y, x, edge)
            if group < 0:
                continue
            k = count[group] - first[group]
            count[group] += 1
            if k >= 0 and k % step[group] == 0 and place[group] < end[group]:
                out[place[group], 0], out[place[group], 1] = y, x
                place[group] += 1
    return total
