"""The interpolation of the person's keyframes is that of scipy's `PchipInterpolator`."""

from itertools import pairwise

import numpy as np
import pytest
import scipy  # its submodules load on first use: they take long to import

from mocapd.sim.person.monotone_cubic import monotone_cubic

RNG = np.random.default_rng(1)
TIMES_S = np.cumsum(RNG.uniform(0.05, 2.0, 12))
VALUES = RNG.normal(size=(12, 5))
VALUES[5] = VALUES[4]  # a rest


@pytest.mark.parametrize("share", [0.0, 0.2, 0.5, 0.9])
def test_it_is_scipys_but_for_the_slopes_at_both_ends(share: float) -> None:
    wanted = scipy.interpolate.PchipInterpolator(TIMES_S, VALUES, axis=0)
    found = monotone_cubic(TIMES_S, VALUES)
    for start_s, end_s in pairwise(TIMES_S[1:-1].tolist()):
        t_s = (1.0 - share) * start_s + share * end_s
        np.testing.assert_allclose(found(t_s), wanted(t_s), atol=1e-12)


def test_both_ends_are_reached() -> None:
    found = monotone_cubic(TIMES_S, VALUES)
    for i in (0, -1):
        np.testing.assert_allclose(found(float(TIMES_S[i])), VALUES[i], atol=1e-12)
