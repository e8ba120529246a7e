"""Pixels spread over the regions of a drawn body, against a plain twin."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from mocapd.fit.rays_in_other_kernels import N_GROUPS, N_PARTS, spread_over_groups
from mocapd.types import Bytes, Ints

pytestmark = pytest.mark.kernels


def naive(
    ids: Bytes, triangle_at: NDArray[np.int32], part: Bytes, edge: int, points: Ints, turn: int
) -> Ints:
    """One group after the other, by numpy."""
    inside, e = ids > 0, edge
    deep = np.zeros_like(inside)
    deep[e:-e, e:-e] = (
        inside[: -2 * e, e:-e] & inside[2 * e :, e:-e] & inside[e:-e, : -2 * e] & inside[e:-e, 2 * e :]
    )  # fmt: skip
    y, x = np.nonzero(deep & inside)
    which = part[triangle_at[y, x]].astype(np.int64) * 16 + ids[y, x]
    rows = [np.empty(0, np.int64)]
    for one in np.unique(which).tolist():
        mine = np.flatnonzero(which == one)
        most = int(points[one // 16])
        step = max(len(mine) // most, 1)
        rows.append(mine[turn % step :: step][:most])
    picked = np.concatenate(rows)
    return np.stack([y[picked], x[picked]], axis=1)


@given(st.integers(0, 2**32 - 1), st.integers(0, 500))
def test_as_many_of_each_group_evenly_and_others_each_turn(seed: int, turn: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.integers(1, 13, N_PARTS)
    ids = np.kron(rng.integers(0, 5, (4, 5)), np.ones((11, 9), int)).astype(np.uint8)
    part = rng.integers(0, 6, 40).astype(np.uint8)
    triangle_at = np.where(ids > 0, rng.integers(0, 40, ids.shape), -1).astype(np.int32)
    out = np.empty((12 * N_GROUPS, 2), np.int64)
    n = spread_over_groups(ids, triangle_at, part, 2, points, turn, out)
    assert np.array_equal(out[:n], naive(ids, triangle_at, part, 2, points, turn))


def test_a_picture_smaller_than_its_edges_has_none() -> None:
    ids, triangle_at = np.ones((3, 4), np.uint8), np.zeros((3, 4), np.int32)
    out = np.empty((N_GROUPS, 2), np.int64)
    assert (
        spread_over_groups(
            ids, triangle_at, np.zeros(1, np.uint8), 2, np.ones(N_PARTS, np.int64), 0, out
        )
        == 0
    )
