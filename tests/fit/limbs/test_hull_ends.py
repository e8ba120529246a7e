"""An arm that silhouettes show beside the drawn body is found by the end of the hull."""

import numpy as np
import pytest

from mocapd.body.skeleton import INDEX
from mocapd.fit.limbs.hull_ends import HullEndParams, hull_views, wrist_at_hull_end
from mocapd.fit.motion_state import MotionState
from mocapd.types import Floats
from tests.fit.synthetic import fitter, standing, views_of

pytestmark = pytest.mark.kernels

BY = fitter(3)
PARAMS = HullEndParams()


def wrists_m(state: MotionState) -> Floats:
    return BY.joints(state)[0][[INDEX["leftHand"], INDEX["rightHand"]]]


def found_m(drawn: MotionState, seen: MotionState, side: str, cameras: int = 3) -> Floats | None:
    """The wrist of a body drawn in one pose, in pictures of another."""
    views = views_of(BY, seen)[:cameras]
    for view in views:
        BY.drawings[view.index].render(drawn, 0.0, view.roi)
    beside = hull_views(BY, views, PARAMS)
    if beside is None:
        return None
    return wrist_at_hull_end(BY, BY.joints(drawn)[0], side, beside, PARAMS)


def test_the_wrist_is_found_where_the_arm_was_raised_unseen() -> None:
    seen, drawn = standing("goalpost", "side_low"), standing("side_low", "side_low")
    place_m = found_m(drawn, seen, "left")
    assert place_m is not None
    assert np.linalg.norm(wrists_m(drawn)[0] - wrists_m(seen)[0]) > 0.4
    assert np.linalg.norm(place_m - wrists_m(seen)[0]) < 0.2


def test_an_arm_where_it_is_seen_has_no_other_end() -> None:
    state = standing()
    assert found_m(state, state, "left") is None
    seen, drawn = standing("goalpost", "side_low"), standing("side_low", "side_low")
    assert found_m(drawn, seen, "right") is None, "the other arm's end is not this one's"


def test_one_camera_that_sees_something_beside_the_body_does_not_count() -> None:
    seen, drawn = standing("goalpost", "side_low"), standing("side_low", "side_low")
    assert found_m(drawn, seen, "left", cameras=1) is None
