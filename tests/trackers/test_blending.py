"""What was shown wrongly glides to where the body is."""

import numpy as np
import pytest

from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.geometry import rotations
from mocapd.trackers.blending import Residual, blended, later, residual
from mocapd.types import Floats

AT_REST = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
ARM = INDEX["leftUpperArm"]


def shown(way: Residual | None, root: Floats, local: Floats) -> list[tuple[Floats, Floats]]:
    """Root and local rotations in each frame until nothing is left."""
    out = []
    while way is not None:
        out.append(blended(root, local, way))
        way = later(way)
    return out


def test_it_goes_there_in_equal_steps_no_longer_than_allowed() -> None:
    wrong = AT_REST.copy()
    wrong[ARM] = rotations.exp(np.array([0.0, 0.0, 1.0]))
    steps = shown(
        residual(np.zeros(3), wrong, np.zeros(3), AT_REST, 0.28, 0.07), np.zeros(3), AT_REST
    )
    angles = [rotations.angle_rad(local[ARM], AT_REST[ARM]) for _, local in steps]
    np.testing.assert_allclose(angles, [0.75, 0.5, 0.25], atol=1e-9)


def test_the_body_moves_on_meanwhile() -> None:
    way = residual(np.array([0.2, 0.0, 0.0]), AT_REST, np.zeros(3), AT_REST, 0.2, 0.1)
    ((root, _),) = shown(way, np.array([0.0, 1.0, 0.0]), AT_REST)
    np.testing.assert_allclose(root, [0.1, 1.0, 0.0])


@pytest.mark.parametrize("farthest_m", [0.0, 0.01, 0.07])
def test_what_is_hardly_off_is_right_at_once(farthest_m: float) -> None:
    way = residual(np.full(3, 0.01), AT_REST, np.zeros(3), AT_REST, farthest_m, 0.07)
    for root, _ in shown(way, np.zeros(3), AT_REST):
        np.testing.assert_allclose(root, 0.0, atol=1e-12)


def test_however_far_it_is_there_in_a_quarter_of_a_second() -> None:
    way = residual(np.full(3, 5.0), AT_REST, np.zeros(3), AT_REST, 9.0, 0.07)
    assert len(shown(way, np.zeros(3), AT_REST)) == 7
