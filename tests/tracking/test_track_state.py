"""Where a body is expected: a root that three cameras place goes on as it went."""

import numpy as np
import pytest

from mocapd.body.model import build_model
from mocapd.body.pose_space import full_body
from mocapd.fit.motion_state import initial_information
from mocapd.tracking.track_state import BodyShapeEstimate, TrackState, t_pose_state

pytestmark = pytest.mark.kernels
BODY = build_model(1.75, full_body())


@pytest.mark.parametrize(("cameras", "share"), [(("a",), 0.6), (("a", "b"), 0.6), (("a", "b", "c"), 1.0)])  # fmt: skip
def test_the_root_keeps_its_speed_where_three_cameras_know_it(
    cameras: tuple[str, ...], share: float
) -> None:
    wearer = BodyShapeEstimate(np.ones(BODY.n_shape), initial_information(BODY.space), 0.0)
    motion = t_pose_state(BODY, np.zeros(3), wearer)
    motion.velocity[:3] = 0.0, 3.0, 0.0
    predicted = TrackState(0, motion, cameras).predicted(BODY, 0.1, 0.6)
    assert predicted.root_m == pytest.approx([0.0, share * 0.3, 0.0])
