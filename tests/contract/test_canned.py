"""The canned loop: smooth, lively, asymmetric, and closed."""

import numpy as np

from mocapd.body.skeleton import INDEX, joint_positions, standard_skeleton
from mocapd.trackers.canned.canned_motion import CannedMotion
from mocapd.trackers.canned.tracker import canned_pose
from mocapd.types import Floats

SKELETON = standard_skeleton(1.7)
MS = 1_000_000


def joints_at(t_ns: int) -> Floats:
    return joint_positions(SKELETON, canned_pose(SKELETON, CannedMotion(), t_ns))


def test_the_loop_closes_and_goes_on_for_years() -> None:
    loop_ns = 4_000 * MS
    for t_ns in (0, 1_234 * MS):
        assert np.allclose(joints_at(t_ns), joints_at(t_ns + loop_ns * 20_000_000), atol=1e-12)
    assert np.abs(joints_at(loop_ns - MS) - joints_at(loop_ns)).max() < 0.02


def test_it_moves_as_a_person_can() -> None:
    track = np.array([joints_at(k * 10 * MS) for k in range(400)])
    speed_m_s = np.linalg.norm(np.diff(track, axis=0), axis=-1) / 0.01
    assert speed_m_s.max() < 4.0
    assert speed_m_s[:, INDEX["leftHand"]].max() > 0.5
    assert track[:, :, 1].min() > -0.01  # above the floor


def test_the_left_hand_is_up_and_the_right_is_down() -> None:
    joints_m = joints_at(500 * MS)
    assert joints_m[INDEX["leftHand"], 1] > joints_m[INDEX["head"], 1] - 0.1
    assert joints_m[INDEX["rightHand"], 1] < joints_m[INDEX["chest"], 1]
    assert joints_m[INDEX["leftHand"], 0] > 0.2 > -0.1 > joints_m[INDEX["rightHand"], 0]
