"""The plain rotations do what the arrays of rotations do."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from mocapd.geometry import rotations
from mocapd.outputs import quaternions

VECTORS = arrays(np.float64, 3, elements=st.floats(-1.8, 1.8))


@given(VECTORS, VECTORS, VECTORS)
def test_as_with_arrays(a: np.ndarray, b: np.ndarray, v: np.ndarray) -> None:
    p, q = quaternions.exp(tuple(a)), quaternions.exp(tuple(b))
    assert p == pytest.approx(rotations.exp(a), abs=1e-12)
    assert quaternions.multiply(p, q) == pytest.approx(
        rotations.multiply(rotations.exp(a), rotations.exp(b)), abs=1e-12
    )
    turned = quaternions.rotate(p, tuple(v))
    assert turned == pytest.approx(rotations.to_matrix(rotations.exp(a)) @ v, abs=1e-12)
    assert quaternions.rotate(quaternions.inverse(p), turned) == pytest.approx(v, abs=1e-12)


@given(VECTORS)
def test_log_is_the_shortest_way_back(v: np.ndarray) -> None:
    assert quaternions.log(quaternions.exp(tuple(v))) == pytest.approx(v, abs=1e-7)
    x, y, z, w = quaternions.exp(tuple(v))
    assert quaternions.log((-x, -y, -z, -w)) == pytest.approx(v, abs=1e-7)
