"""Each arm where the other one is: hands change places, elbows come near, and nothing else moves."""

import numpy as np
import pytest

from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import INDEX
from mocapd.fit.limbs.arm_samples import arm_of
from mocapd.fit.limbs.arm_search import with_arms_exchanged
from mocapd.fit.limbs.hand_target_poses import hand_poses
from mocapd.fit.limbs.limb_fits import with_limb
from mocapd.fit.motion_state import MotionState
from tests.fit.synthetic import LABELS, MODEL, fitter, standing

pytestmark = pytest.mark.kernels

ARMS = {side: arm_of(MODEL, LABELS, side) for side in SIDES}
BY = fitter(1)


def with_hands(
    left_m: tuple[float, float, float], right_m: tuple[float, float, float]
) -> MotionState:
    """Somebody who stands with each hand at a place from the middle between the shoulders [m]."""
    state = standing()
    joints, globals_ = BY.joints(state)
    middle = joints[[arm.chain[1] for arm in ARMS.values()]].mean(axis=0)
    for arm, place in zip(ARMS.values(), (left_m, right_m), strict=True):
        present = state.local_xyzw[arm.chain[:3]]
        to = hand_poses((middle + place)[None], joints, globals_, arm, present)
        state = with_limb(state, arm, to[0])
    return state


@pytest.mark.parametrize(
    ("left_m", "right_m"),
    [((0.05, 0.0, 0.35), (-0.05, -0.3, 0.3)), ((0.0, 0.0, 0.45), (0.1, -0.2, 0.35))],
)
def test_hands_change_places_and_the_rest_stays(
    left_m: tuple[float, float, float], right_m: tuple[float, float, float]
) -> None:
    state = with_hands(left_m, right_m)
    exchanged = with_arms_exchanged(BY, state, ARMS)
    before, after = BY.joints(state)[0], BY.joints(exchanged)[0]
    for side, other in (SIDES, SIDES[::-1]):
        np.testing.assert_allclose(
            after[INDEX[side + "Hand"]], before[INDEX[other + "Hand"]], atol=0.01
        )
    moved = [INDEX[side + bone] for side in SIDES for bone in ("UpperArm", "LowerArm")]
    still = np.ones(len(state.local_xyzw), bool)
    still[moved] = False
    np.testing.assert_array_equal(exchanged.local_xyzw[still], state.local_xyzw[still])
    assert not exchanged.velocity.any()


def test_elbows_come_as_near_to_the_others_as_the_swivels_tried() -> None:
    state = with_hands((0.0, 0.0, 0.4), (0.0, -0.25, 0.3))
    joints, globals_ = BY.joints(state)
    exchanged = with_arms_exchanged(BY, state, ARMS)
    after = BY.joints(exchanged)[0]
    for side, other in (SIDES, SIDES[::-1]):
        arm, its = ARMS[side], ARMS[other]
        tried = hand_poses(
            joints[its.chain[3:4]], joints, globals_, arm, state.local_xyzw[arm.chain[:3]]
        )
        elbows = [BY.joints(with_limb(state, arm, pose))[0][arm.chain[2]] for pose in tried]
        away_m = np.linalg.norm(np.array(elbows) - joints[its.chain[2]], axis=1)
        found_m = np.linalg.norm(after[arm.chain[2]] - joints[its.chain[2]])
        assert found_m == pytest.approx(away_m.min(), abs=1e-6)
        assert away_m.max() > away_m.min() + 0.1
