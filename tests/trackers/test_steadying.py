"""What is told follows what was found: at once where the pictures confirm it, slowly where they hardly do."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.geometry import rotations
from mocapd.trackers.steadying import SteadyingParams, Told, behind, steadied
from mocapd.trackers.steadying_kernels import follow
from mocapd.types import Floats, Pose
from tests.trackers import naive_steadying

ARM, FOREARM, ELBOW = INDEX["leftUpperArm"], INDEX["leftLowerArm"], INDEX["leftLowerArm"]
FRAME_NS = 33_333_333
PARAMS = SteadyingParams(settles_s=0.0)
SURE, DOUBTFUL = np.ones(N_JOINTS), np.zeros(N_JOINTS)


def turned(rad: float, bone: int = ARM, root_m: float = 0.0) -> Pose:
    quats = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    quats[bone] = rotations.exp(np.array([0.0, 0.0, rad]))
    return Pose(np.array([root_m, 1.0, 0.0]), quats)


def rad(told: Told, bone: int = ARM) -> float:
    return float(rotations.angle_rad(told.pose.quats_xyzw[bone], rotations.IDENTITY_XYZW))


def followed(found: Pose, confidence: Floats, times: int, fps: float = 30.0) -> list[Told]:
    """Somebody who was told to be at rest, then is found otherwise."""
    told, out = steadied(turned(0.0), confidence, 0, None, PARAMS), []
    for n in range(1, times + 1):
        told = steadied(found, confidence, round(1e9 * n / fps), told, PARAMS)
        out.append(told)
    return out


def test_what_is_confirmed_is_told_nearly_as_it_was_found_and_so_in_the_next_frame() -> None:
    first, second = followed(turned(0.4, root_m=0.2), SURE, 2)
    assert 0.75 * 0.4 < rad(first) < 0.4
    assert 0.65 * 0.2 < first.pose.root_m[0] < 0.2
    assert rad(second) == pytest.approx(0.4, rel=0.04)


def test_what_is_hardly_confirmed_follows_slowly_and_gets_there() -> None:
    path = [rad(told) for told in followed(turned(1.0), DOUBTFUL, 60)]
    steps = np.diff([0.0, *path])
    assert (steps > 0.0).all()
    assert steps.max() <= PARAMS.upper_arm.doubtful_rad_s / 30.0 + 1e-6
    assert path[-1] == pytest.approx(1.0, abs=1e-3)


def test_each_bone_by_the_joint_that_it_leads_to() -> None:
    elbow_hidden = SURE.copy()
    elbow_hidden[ELBOW] = 0.0
    (told,) = followed(turned(0.4), elbow_hidden, 1)
    assert rad(told) < 0.4 * 0.4
    (told,) = followed(turned(0.4, FOREARM), elbow_hidden, 1)
    assert rad(told, FOREARM) > 0.75 * 0.4


def test_of_the_same_confidence_legs_are_followed_closer_than_arms() -> None:
    half = np.full(N_JOINTS, 0.5)
    bones = [INDEX["left" + bone] for bone in ("LowerArm", "UpperArm", "LowerLeg", "UpperLeg")]
    told = []
    for bone in bones:
        path = steadied(turned(0.0, bone), half, 0, None, PARAMS)
        for n in range(1, 3):
            path = steadied(turned(0.5, bone), half, n * FRAME_NS, path, PARAMS)
        told.append(rad(path, bone))
    assert max(told[:2]) < min(told[2:]) < 0.5


def test_no_bone_turns_faster_than_people_turn() -> None:
    (told,) = followed(turned(2.0), SURE, 1)
    assert 0.75 * PARAMS.sure_rad_s / 30.0 < rad(told) <= PARAMS.sure_rad_s / 30.0


def test_twice_the_frames_follow_as_fast() -> None:
    at_30 = followed(turned(0.2), DOUBTFUL, 5, fps=30.0)[-1]
    at_60 = followed(turned(0.2), DOUBTFUL, 10, fps=60.0)[-1]
    assert rad(at_60) == pytest.approx(rad(at_30), rel=1e-6)


def test_trust_comes_back_bit_by_bit() -> None:
    told = steadied(turned(0.0), DOUBTFUL, 0, None, PARAMS)
    told = steadied(turned(0.0), SURE, FRAME_NS, told, PARAMS)
    assert 0.0 < told.trust[ARM] < 0.1
    for n in range(2, 30):
        told = steadied(turned(0.0), SURE, n * FRAME_NS, told, PARAMS)
    assert told.trust[ARM] == 1.0


def test_a_bone_that_was_found_elsewhere_glides_there() -> None:
    told = steadied(turned(0.0), SURE, 0, None, PARAMS)
    jumped = steadied(turned(1.0), SURE, FRAME_NS, told, PARAMS, [ARM])
    assert 0.0 < rad(jumped) <= PARAMS.upper_arm.doubtful_rad_s / 30.0 + 1e-3


def turning(params: SteadyingParams, stops: int) -> list[float]:
    """How far behind it is told, frame by frame, of an arm that turns by 2 rad/s and stops; hardly sure [rad]."""
    told, behind_rad = steadied(turned(0.0), 0.7 * SURE, 0, None, params), []
    for n in range(1, 60):
        found_rad = 2.0 * min(n, stops) / 30.0
        told = steadied(turned(found_rad), 0.7 * SURE, n * FRAME_NS, told, params)
        behind_rad.append(found_rad - rad(told))
    return behind_rad


def test_a_bone_that_keeps_turning_is_less_left_behind_and_stops_with_it() -> None:
    glides, stays = turning(PARAMS, 30), turning(replace(PARAMS, glide=0.0), 30)
    assert 0.0 < glides[29] < 0.75 * stays[29]
    assert min(glides) > -0.5 * stays[29]  # it does not swing far beyond
    assert abs(glides[-1]) < 1e-3


def test_a_bone_that_was_found_elsewhere_does_not_go_on_as_it_went() -> None:
    told = steadied(turned(0.0), SURE, 0, None, PARAMS)
    for n in range(1, 20):
        told = steadied(turned(0.1 * n), SURE, n * FRAME_NS, told, PARAMS)
    before = rad(told)
    told = steadied(turned(0.0), SURE, 20 * FRAME_NS, told, PARAMS, [ARM])
    assert rad(told) < before


def test_after_a_gap_it_begins_anew() -> None:
    told = steadied(turned(0.0), DOUBTFUL, 0, None, PARAMS)
    assert rad(steadied(turned(1.0), DOUBTFUL, 600_000_000, told, PARAMS)) == pytest.approx(1.0)


def test_a_joint_that_is_told_beside_where_it_was_found_is_less_certain() -> None:
    found = np.zeros((2, 3))
    told = np.array([[0.0, 0.0, 0.0], [0.3, 0.0, 0.0]])
    np.testing.assert_allclose(
        behind(np.array([0.02, 0.02]), told, found), [0.02, np.hypot(0.02, 0.3 / np.sqrt(3.0))]
    )


def test_who_was_just_found_is_told_as_found_until_settled() -> None:
    usual = SteadyingParams()
    told = steadied(turned(0.0), DOUBTFUL, 0, None, usual)
    behind_rad = []
    for n in range(1, 20):
        told = steadied(turned(0.1 * n), DOUBTFUL, n * FRAME_NS, told, usual)
        behind_rad.append(0.1 * n - rad(told))
    settled = round(usual.settles_s * 30.0)
    np.testing.assert_allclose(behind_rad[: settled - 1], 0.0, atol=1e-9)
    assert behind_rad[settled + 2] > 0.05


@given(st.integers(0, 2**32 - 1))
def test_bones_one_by_one_go_as_the_formula_says(seed: int) -> None:
    rng = np.random.default_rng(seed)
    last = rotations.canonical(rotations.exp(rng.normal(0.0, 0.8, (N_JOINTS, 3))))
    found = rotations.multiply(rotations.exp(rng.normal(0.0, 0.5, (N_JOINTS, 3))), last)
    turning, trust = rng.normal(0.0, 3.0, (N_JOINTS, 3)), rng.random(N_JOINTS)
    following = np.array([
        rng.uniform(1.0, 2.5, N_JOINTS), rng.uniform(0.0, 0.3, N_JOINTS), rng.uniform(0.1, 0.5, N_JOINTS),
        rng.uniform(2.0, 10.0, N_JOINTS), rng.choice([1.0, 3.0], N_JOINTS),
    ])  # fmt: skip
    gap_s = float(rng.uniform(0.003, 0.2))
    how = (trust, following, gap_s, 30.0 * gap_s, 0.75, 0.65, 20.0)
    told, now = naive_steadying.followed(found, last, *how, turning)
    out, shares = np.empty((N_JOINTS, 4)), (np.empty(N_JOINTS), np.empty(N_JOINTS))
    follow(found, last, *how, turning, out, *shares)
    assert out == pytest.approx(told, abs=1e-9)
    assert turning == pytest.approx(now, abs=1e-7)
