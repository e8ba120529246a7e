"""The pose filter: what the pictures confirm is published nearly as found, what they hardly confirm follows slowly, and a
change of the cues moves no joint in a jump."""

from collections.abc import Callable, Collection

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocapd.body.skeleton import INDEX, N_JOINTS, joint_positions, standard_skeleton
from mocapd.geometry import rotations
from mocapd.tracking.bone_gains import Carrier
from mocapd.tracking.pose_filter import PoseFilter, PoseFilterParams
from mocapd.tracking.pose_filter_kernels import follow_bones
from mocapd.types import Floats, Pose
from tests.tracking import naive_pose_filter

SKELETON = standard_skeleton(1.75)
ARM, FOREARM, ELBOW = INDEX["leftUpperArm"], INDEX["leftLowerArm"], INDEX["leftLowerArm"]
LEG, SPINE = INDEX["leftUpperLeg"], INDEX["spine"]
SURE, DOUBTFUL = np.ones(N_JOINTS), np.zeros(N_JOINTS)
PARAMS = PoseFilterParams()
SETTLED_S = PARAMS.settles_s + 0.1
RATES = pytest.mark.parametrize("hz", [15.0, 30.0, 60.0])


def turned(rad: float, bone: int = ARM, x_m: float = 0.0) -> Pose:
    quats = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    quats[bone] = rotations.exp(np.array([0.0, 0.0, rad]))
    return Pose(np.array([x_m, 1.0, 0.0]), quats)


def rad(pose: Pose, bone: int = ARM) -> float:
    return float(rotations.angle_rad(pose.quats_xyzw[bone], rotations.IDENTITY_XYZW))


class Stepped:
    """A filter that is stepped at a rate."""

    def __init__(
        self,
        hz: float = 30.0,
        carrier: str = "clothes",
        cameras: int = 2,
        from_one_side: bool = False,
    ) -> None:
        self.filter, self.hz, self.now_s = PoseFilter(), hz, 0.0
        self.carrier, self.cameras, self.from_one_side = carrier, cameras, from_one_side

    def step(
        self,
        found: Pose,
        confidence: Floats = SURE,
        jumped: Collection[int] = (),
        legs_since_ns: int | None = None,
    ) -> Pose:
        is_shirt = self.carrier.startswith("shirt")
        by = Carrier(self.carrier, is_shirt, self.cameras, self.from_one_side)
        t_ns = round(1e9 * self.now_s)
        self.now_s += 1.0 / self.hz
        return self.filter.step(found, confidence, t_ns, by, SKELETON, jumped, legs_since_ns)

    def settle(self, found: Pose, confidence: Floats = SURE) -> "Stepped":
        """Somebody who has been found there for a while."""
        while self.now_s < SETTLED_S:
            self.step(found, confidence)
        return self


def test_a_confirmed_bone_is_published_nearly_as_found_and_so_in_the_next_frame() -> None:
    one = Stepped().settle(turned(0.0))
    first, second = (one.step(turned(0.4, x_m=0.1)) for _ in range(2))
    assert 0.75 * 0.4 < rad(first) < 0.4
    assert rad(second) == pytest.approx(0.4, rel=0.04)
    assert 0.5 * 0.1 < first.root_m[0] < second.root_m[0] <= 0.12


def test_the_shirts_trunk_and_confirmed_arms_are_published_as_found() -> None:
    one = Stepped(carrier="shirt").settle(turned(0.0))
    pose = one.step(turned(0.4, x_m=0.1))
    assert rad(pose) == pytest.approx(0.4)
    assert pose.root_m[0] == pytest.approx(0.1)


def test_the_shirt_seen_from_one_side_trembles_less_and_is_followed_as_well() -> None:
    amplitudes = []
    for from_one_side in (False, True):
        one = Stepped(carrier="shirt", from_one_side=from_one_side).settle(turned(0.0))
        path = [one.step(turned(0.01 * (-1) ** k, SPINE, x_m=0.003 * (-1) ** k)) for k in range(40)]
        amplitudes.append([max(rad(pose, SPINE), abs(pose.root_m[0])) for pose in path[-4:]])
        pose = one.step(turned(0.4, x_m=0.1))
        assert rad(pose) == pytest.approx(0.4, rel=0.02)
        assert pose.root_m[0] == pytest.approx(0.1, rel=0.02)
    assert max(amplitudes[1]) < 0.5 * min(amplitudes[0])


@pytest.mark.parametrize("carrier", ["clothes", "shirt"])
def test_a_doubtful_arm_follows_slowly_and_gets_there(carrier: str) -> None:
    one = Stepped(carrier=carrier).settle(turned(0.0), DOUBTFUL)
    path = [rad(one.step(turned(1.0), DOUBTFUL)) for _ in range(60)]
    steps = np.diff([0.0, *path])
    assert (steps >= -1e-9).all()
    assert steps.max() < 0.5
    assert path[-1] == pytest.approx(1.0, abs=1e-3)


def test_each_bone_follows_by_the_joint_that_it_leads_to() -> None:
    elbow_hidden = SURE.copy()
    elbow_hidden[ELBOW] = 0.0
    upper, fore = (
        rad(Stepped().settle(turned(0.0), elbow_hidden).step(turned(0.4, bone), elbow_hidden), bone)
        for bone in (ARM, FOREARM)
    )
    assert upper < 0.4 * 0.4
    assert fore > 0.75 * 0.4


def test_of_the_same_confidence_legs_are_followed_closer_than_arms() -> None:
    half = np.full(N_JOINTS, 0.5)
    after = []
    for bone in [INDEX["left" + b] for b in ("LowerArm", "UpperArm", "LowerLeg", "UpperLeg")]:
        one = Stepped().settle(turned(0.0), half)
        one.step(turned(0.5, bone), half)
        after.append(rad(one.step(turned(0.5, bone), half), bone))
    assert max(after[:2]) < min(after[2:]) < 0.5


def test_no_bone_turns_faster_than_people_turn() -> None:
    pose = Stepped().settle(turned(0.0)).step(turned(2.0))
    assert 0.3 < rad(pose) <= 20.0 / 30.0 + 1e-6


@RATES
def test_the_frame_rate_does_not_matter(hz: float) -> None:
    """Of an arm that nothing confirms, a third of a second later."""
    reached = {}
    for rate in (30.0, hz):
        one = Stepped(rate).settle(turned(0.0), DOUBTFUL)
        for _ in range(round(rate / 3.0)):
            pose = one.step(turned(0.2), DOUBTFUL)
        reached[rate] = rad(pose)
    assert 0.1 < reached[hz] < 0.2
    assert reached[hz] == pytest.approx(reached[30.0], rel=1e-6)


def test_trust_comes_back_bit_by_bit() -> None:
    """An arm that was doubtful a moment ago is not followed at once as one that was sure all the time."""
    was_sure, was_doubtful = (Stepped().settle(turned(0.0), c) for c in (SURE, DOUBTFUL))
    assert rad(was_doubtful.step(turned(0.4))) < 0.5 * rad(was_sure.step(turned(0.4)))


def test_a_bone_that_keeps_turning_is_little_left_behind_and_stops_with_it() -> None:
    one, behind_rad = Stepped().settle(turned(0.0), 0.7 * SURE), []
    for n in range(1, 60):
        found_rad = 2.0 * min(n, 30) / 30.0
        behind_rad.append(found_rad - rad(one.step(turned(found_rad), 0.7 * SURE)))
    assert 0.0 < behind_rad[29] < 0.06  # of the 0.067 that it turns in a frame
    assert min(behind_rad) > -0.06  # it does not swing far beyond
    assert abs(behind_rad[-1]) < 1e-3


def test_who_was_just_found_is_published_as_found_until_settled() -> None:
    one = Stepped()
    behind_rad = [0.1 * n - rad(one.step(turned(0.1 * n), DOUBTFUL)) for n in range(20)]
    settled = round(PARAMS.settles_s * 30.0)
    np.testing.assert_allclose(behind_rad[:settled], 0.0, atol=1e-9)
    assert behind_rad[settled + 2] > 0.05


def test_legs_just_found_are_published_as_found() -> None:
    for since_s, exact in ((SETTLED_S, True), (0.0, False)):
        one = Stepped(carrier="shirt+clothes").settle(turned(0.0))
        pose = one.step(turned(0.6, LEG), DOUBTFUL, legs_since_ns=round(1e9 * since_s))
        assert (rad(pose, LEG) == pytest.approx(0.6)) is exact


def test_after_a_gap_it_starts_anew() -> None:
    one = Stepped().settle(turned(0.0), DOUBTFUL)
    one.now_s += 0.6
    assert rad(one.step(turned(1.0, x_m=0.5), DOUBTFUL)) == pytest.approx(1.0)


# --- changes of the cues ---


def steps_m(poses: list[Pose], own_m: Callable[[int], float] = lambda _: 0.0) -> Floats:
    """The farthest that a joint went in each frame, beside its own motion along z (frame by frame [m])."""
    moved = np.array([joint_positions(SKELETON, pose) for pose in poses])
    moved[..., 2] -= np.array([own_m(k) for k in range(len(poses))])[:, None]
    out: Floats = np.linalg.norm(np.diff(moved, axis=0), axis=2).max(axis=1)
    return out


@RATES
@pytest.mark.parametrize("apart_m", [0.1, 0.3, 0.6])
def test_a_change_of_cues_moves_no_joint_in_a_jump_and_ends_soon(hz: float, apart_m: float) -> None:
    one = Stepped(hz, "shirt+clothes").settle(turned(0.0))
    poses = [one.step(turned(0.0))]
    one.carrier = "shirt"
    poses += [one.step(turned(0.0, x_m=apart_m)) for _ in range(round(hz))]
    steps = steps_m(poses)
    assert steps.max() <= PARAMS.step_m + 1e-9
    assert steps.max() > 0.4 * PARAMS.approach_m_s / hz
    slowest_s = max(PARAMS.approach_s, apart_m / (PARAMS.step_m * hz))
    moving = np.flatnonzero(steps > 1e-6)
    assert moving[-1] + 1 <= np.ceil(slowest_s * hz) + 1
    assert poses[-1].root_m[0] == pytest.approx(apart_m)


def test_whoever_runs_is_not_held_back_at_a_change_of_cues() -> None:
    """At 15 cm a frame, and both sets of cues find the same."""
    one, poses = Stepped(carrier="shirt+clothes"), []
    for n in range(40):
        one.carrier = "shirt+clothes" if n < 20 else "shirt"
        poses.append(one.step(Pose(np.array([0.0, 1.0, 0.15 * n]), turned(0.0).quats_xyzw)))
    np.testing.assert_allclose([pose.root_m[2] for pose in poses], 0.15 * np.arange(40), atol=1e-9)


def test_whoever_runs_runs_along_while_the_difference_goes_away() -> None:
    one, poses = Stepped(carrier="shirt+clothes"), []
    for n in range(40):
        one.carrier = "shirt+clothes" if n < 20 else "shirt"
        x_m = 0.0 if n < 20 else 0.3
        poses.append(one.step(Pose(np.array([x_m, 1.0, 0.08 * n]), turned(0.0).quats_xyzw)))
    assert steps_m(poses, lambda k: 0.08 * k).max() <= PARAMS.step_m + 1e-9
    assert poses[-1].root_m == pytest.approx([0.3, 1.0, 0.08 * 39])


def test_cues_that_settle_elsewhere_soon_after_the_change_do_not_jump_either() -> None:
    one = Stepped(carrier="shirt+clothes").settle(turned(0.0))
    poses = [one.step(turned(0.0))]
    one.carrier = "shirt"
    poses += [one.step(turned(0.0, x_m=0.3 if n < 3 else 0.5)) for n in range(30)]
    assert steps_m(poses).max() <= 2.0 * PARAMS.step_m
    assert poses[-1].root_m[0] == pytest.approx(0.5)


def test_an_arm_that_the_shirt_shows_elsewhere_is_approached() -> None:
    one = Stepped(carrier="shirt").settle(turned(0.0))
    poses = [one.step(turned(0.0)), one.step(turned(1.2), jumped=[ARM])]
    poses += [one.step(turned(1.2)) for _ in range(30)]
    assert 0.0 < rad(poses[1]) < 0.6
    assert steps_m(poses).max() <= 1.5 * PARAMS.step_m  # of 0.6 m that the hand is elsewhere
    assert rad(poses[-1]) == pytest.approx(1.2, abs=1e-3)


def test_reset_forgets_what_was_published() -> None:
    one = Stepped(carrier="shirt").settle(turned(0.0))
    one.filter.reset()
    assert one.step(turned(1.2, x_m=2.0)).root_m[0] == 2.0


@given(st.integers(0, 2**32 - 1))
def test_bones_one_by_one_go_as_the_formula_says(seed: int) -> None:
    rng = np.random.default_rng(seed)
    last = rotations.canonical(rotations.exp(rng.normal(0.0, 0.8, (N_JOINTS, 3))))
    found = rotations.multiply(rotations.exp(rng.normal(0.0, 0.5, (N_JOINTS, 3))), last)
    turning, trust = rng.normal(0.0, 3.0, (N_JOINTS, 3)), rng.random(N_JOINTS)
    following = np.array([
        rng.uniform(1.0, 2.5, N_JOINTS), rng.uniform(0.0, 0.3, N_JOINTS), rng.uniform(0.1, 0.5, N_JOINTS),
        rng.uniform(2.0, 10.0, N_JOINTS), rng.uniform(20.0, 60.0, N_JOINTS), rng.choice([1.0, 3.0], N_JOINTS),
        rng.choice([0.0, 0.75], N_JOINTS),
        rng.choice([0.0, 0.3, 1.0], N_JOINTS),
    ])  # fmt: skip
    gap_s = float(rng.uniform(0.003, 0.2))
    memory = np.column_stack(
        [rng.normal(0.0, 0.1, (N_JOINTS, 3)), rng.uniform(0.2, 0.9, (N_JOINTS, 2))]
    )
    how = (trust, following, gap_s, 30.0 * gap_s, 0.65, memory)
    filtered, now, remembered = naive_pose_filter.followed(found, last, *how, turning)
    out, shares = np.empty((N_JOINTS, 4)), (np.empty(N_JOINTS), np.empty(N_JOINTS))
    follow_bones(found, last, *how, turning, out, *shares)
    assert out == pytest.approx(filtered, abs=1e-9)
    assert turning == pytest.approx(now, abs=1e-7)
    assert memory == pytest.approx(remembered, abs=1e-9)


@RATES
@pytest.mark.parametrize(
    ("carrier", "confidence"), [("clothes", 1.0), ("clothes", 0.6), ("shirt+clothes", 1.0)]
)
def test_the_lag_is_how_far_steady_motion_is_published_behind(
    hz: float, carrier: str, confidence: float
) -> None:
    """Of a body whose bones all turn at one speed."""
    one, speed_rad_s = Stepped(hz, carrier), 0.5
    for _ in range(round(4.0 * hz)):
        turn = rotations.exp(np.array([0.0, speed_rad_s * one.now_s, 0.0]))
        found = Pose(np.zeros(3), rotations.canonical(np.tile(turn, (N_JOINTS, 1))))
        published = one.step(found, confidence * SURE)
    behind_s = rotations.angle_rad(found.quats_xyzw, published.quats_xyzw) / speed_rad_s
    assert one.filter.lag_s == pytest.approx(behind_s.mean(), abs=1e-5)
    assert 0.001 < one.filter.lag_s < 0.05
    if carrier != "clothes":  # trunk and arms are published as found
        assert behind_s[[ARM, FOREARM, INDEX["chest"]]].max() < 1e-6


def test_three_cameras_have_less_than_half_of_the_lag_of_two() -> None:
    """Noise of what they find is small, and lag is most of what the filter costs."""
    lags_s = []
    for cameras in (2, 3):
        one = Stepped(cameras=cameras).settle(turned(0.0), 0.8 * SURE)
        for n in range(30):
            one.step(turned(0.05 * n), 0.8 * SURE)
        lags_s.append(one.filter.lag_s)
    assert 0.0 < lags_s[1] < 0.5 * lags_s[0]


def test_what_is_published_as_found_has_no_lag() -> None:
    one = Stepped()
    assert one.filter.lag_s == 0.0
    one.step(turned(0.1))
    assert one.filter.lag_s == 0.0


def test_somebody_who_stands_still_trembles_less_than_what_is_found_and_goes_when_they_go() -> None:
    rng, one = np.random.default_rng(3), Stepped(carrier="shirt")
    found = [turned(float(rng.normal(0.0, 0.006))) for _ in range(90)]
    poses = [one.step(pose) for pose in found]
    assert np.std([rad(pose) for pose in poses[30:]]) < 0.4 * np.std([rad(pose) for pose in found])
    went = [one.step(turned(0.08 * k + float(rng.normal(0.0, 0.006)))) for k in range(1, 9)]
    assert rad(went[-1]) > 0.64 - 0.08
