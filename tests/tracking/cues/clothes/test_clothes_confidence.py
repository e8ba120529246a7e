"""Confidence without the shirt: a limb that its keypoints contradict is believed less, and no other."""

import numpy as np

from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.tracking.joint_confidence import keypoint_agreement


def test_a_hand_that_its_keypoint_contradicts_is_believed_less() -> None:
    assert np.array_equal(keypoint_agreement(None), np.ones(N_JOINTS))
    off_m, hand, last = np.zeros(N_JOINTS), INDEX["leftHand"], 1.0
    for off_m[hand] in (0.05, 0.15, 0.6):
        factor = keypoint_agreement(off_m)
        assert factor[hand] < last
        assert np.array_equal(np.delete(factor, hand), np.ones(N_JOINTS - 1))
        last = factor[hand]
    assert last < 0.1
