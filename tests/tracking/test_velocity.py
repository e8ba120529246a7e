"""The velocity of an arm that no picture confirms."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.body.model import build_model
from mocapd.body.pose_space import full_body
from mocapd.fit.motion_state import initial_information
from mocapd.tracking.track_state import BodyShapeEstimate, t_pose_state
from mocapd.tracking.velocity import velocity_between

pytestmark = pytest.mark.kernels
BODY = build_model(1.75, full_body())
ARM = BODY.space.columns("left_arm")


def left_after_a_fifth_of_a_second(hz: int) -> float:
    wearer = BodyShapeEstimate(np.ones(BODY.n_shape), initial_information(BODY.space), 0.0)
    state = t_pose_state(BODY, BODY.rest_m[0].copy(), wearer)
    state = replace(state, velocity=np.ones(BODY.n_pose))
    for _ in range(hz // 5):
        velocity = velocity_between(BODY, state, state, {"left": 0.0, "right": 0.0}, 1 / hz, ())
        state = replace(state, velocity=velocity)
    return float(state.velocity[ARM].max())


@pytest.mark.parametrize("hz", [15, 30, 60])
def test_a_hidden_arm_slows_down_alike_at_any_frame_rate(hz: int) -> None:
    assert left_after_a_fifth_of_a_second(hz) == pytest.approx(0.7**6, rel=1e-6)
