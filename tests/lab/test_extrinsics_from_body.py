"""How a room is scored: where the cameras stand to each other, in whatever world it was found."""

from dataclasses import replace

import numpy as np
import pytest

from lab.extrinsics_from_body import beside_first, score_extrinsics
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import centre
from mocapd.types import Floats, Rig
from tests.geometry.rigs import looking_at

TRUE = Rig(
    tuple(
        looking_at(name, np.array(eye_m), np.array([0.0, 1.1, 0.0]))
        for name, eye_m in (("left", (-1.4, 1.4, 2.3)), ("right", (1.5, 1.3, 2.2)))
    )
)


def elsewhere(rig: Rig, turn: Floats, shift_m: Floats) -> Rig:
    """The same rig in another world."""
    R = rotations.to_matrix(rotations.exp(turn))
    return Rig(tuple(replace(c, R=c.R @ R.T, t_m=c.t_m - c.R @ R.T @ shift_m) for c in rig.cameras))


def test_the_world_of_a_room_does_not_count() -> None:
    found = elsewhere(TRUE, np.array([0.1, 1.2, -0.3]), np.array([2.0, -0.4, 0.7]))
    result = score_extrinsics(found, TRUE)
    assert result.rotation_deg["right"] == pytest.approx(0.0, abs=1e-5)
    assert result.distance_percent["right"] == pytest.approx(0.0, abs=1e-9)
    for placed, true in zip(beside_first(found, TRUE).cameras, TRUE.cameras, strict=True):
        np.testing.assert_allclose(centre(placed), centre(true), atol=1e-9)


def test_a_turned_and_a_distant_camera_are_told() -> None:
    left, right = TRUE.cameras
    turn = rotations.to_matrix(rotations.exp(np.array([0.0, np.radians(2.0), 0.0])))
    # turned about its own centre, then moved away from the first by a twentieth
    at_m = centre(left) + 1.05 * (centre(right) - centre(left))
    off = replace(right, R=turn @ right.R, t_m=-turn @ right.R @ at_m)
    result = score_extrinsics(Rig((left, off)), TRUE)
    assert result.rotation_deg["right"] == pytest.approx(2.0, abs=1e-6)
    assert result.distance_percent["right"] == pytest.approx(5.0, abs=1e-9)
