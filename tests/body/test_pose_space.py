"""The two pose spaces: their order, their parts, their limits in postures that everybody knows."""

import numpy as np
import pytest

from mocapd.body.pose_space import full_body, upper_body
from mocapd.body.shape import FACTORS, WHOLE_FACTORS
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.errors import ConfigError
from mocapd.geometry import rotations
from mocapd.types import Floats
from tests.body.soft_limits import soft_limit

MIRROR = np.array([1.0, -1.0, -1.0])  # of a rotation vector, in x = 0


def posed(**turns_deg: tuple[float, float, float]) -> Floats:
    """Local rotations (J,4), rotation vectors by joint, of the left side those of the left side."""
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    for name, turn in turns_deg.items():
        local[INDEX[name]] = rotations.exp(np.radians(np.array(turn)))
    return local


def mirrored(local_xyzw: Floats) -> Floats:
    """The pose in the mirror x = 0."""
    out = np.empty_like(local_xyzw)
    for name, j in INDEX.items():
        other = name
        for a, b in (("left", "right"), ("right", "left")):
            if name.startswith(a):
                other = b + name.removeprefix(a)
        out[INDEX[other]] = local_xyzw[j] * np.array([*MIRROR, 1.0])
    return out


def excess_deg(local_xyzw: Floats) -> float:
    """How far beyond the limits the pose is at its worst, the same seen in the mirror."""
    worst = [
        float(np.degrees(np.abs(soft_limit(full_body().limits, local)[1]).max()))
        for local in (local_xyzw, mirrored(local_xyzw))
    ]
    assert worst[0] == pytest.approx(worst[1], abs=1e-9)
    return worst[0]


def test_the_upper_space_has_the_parameters_that_recorded_steps_have() -> None:
    space = upper_body()
    assert (space.n_pose, space.n_shape) == (27, 7)
    assert space.factors == FACTORS
    assert [names[0] for names in space.groups] == [
        "hips", "spine", "leftShoulder", "leftUpperArm", "leftLowerArm",
        "rightShoulder", "rightUpperArm", "rightLowerArm",
    ]  # fmt: skip


def test_the_full_space_begins_with_the_upper_one() -> None:
    upper, full = upper_body(), full_body()
    assert (full.n_pose, full.n_shape) == (48, 12)
    assert full.groups[: len(upper.groups)] == upper.groups
    assert full.factors == WHOLE_FACTORS
    np.testing.assert_array_equal(full.factor_sd[: upper.n_shape], upper.factor_sd)
    for a, b in zip(full.limits, upper.limits, strict=True):
        same = slice(None) if len(b) == N_JOINTS else slice(len(b))
        if len(b) != N_JOINTS:  # the share of a joint that does not move does not matter
            np.testing.assert_array_equal(a[same], b)
    moving = upper.group_of_joint >= 0
    np.testing.assert_array_equal(full.limits.share[moving], upper.limits.share[moving])


def test_parts_are_columns() -> None:
    for space in (upper_body(), full_body()):
        assert space.columns("left_arm") == slice(9, 18)
        assert space.columns("right_arm") == slice(18, 27)
    assert full_body().columns("left_leg") == slice(30, 39)
    assert full_body().columns("head") == slice(27, 30)


def test_a_joint_that_does_not_move_has_no_group() -> None:
    assert full_body().group("head") == full_body().group("neck")
    with pytest.raises(ConfigError, match="does not move"):
        upper_body().group("leftUpperLeg")


# --- limits ----------------------------------------------------------------------------------

SQUAT = posed(
    leftUpperLeg=(-115.0, 10.0, 20.0), leftLowerLeg=(135.0, 0.0, 0.0), leftFoot=(-30.0, 0.0, 0.0),
    rightUpperLeg=(-115.0, -10.0, -20.0), rightLowerLeg=(135.0, 0.0, 0.0),
    rightFoot=(-30.0, 0.0, 0.0), spine=(10.0, 0.0, 0.0), neck=(-10.0, 0.0, 0.0),
)  # fmt: skip
# as recorded: knees apart and a little behind hips that stay upright, heels up
KNEES_APART = posed(
    leftUpperLeg=(-75.0, 43.0, 88.0), leftLowerLeg=(150.0, 0.0, 0.0), leftFoot=(25.0, -30.0, 0.0),
    rightUpperLeg=(-75.0, -43.0, -88.0), rightLowerLeg=(150.0, 0.0, 0.0), rightFoot=(25.0, 30.0, 0.0),
)  # fmt: skip
KICK = posed(
    leftUpperLeg=(-95.0, 5.0, 0.0), leftLowerLeg=(5.0, 0.0, 0.0), leftFoot=(50.0, 0.0, 0.0),
    rightUpperLeg=(12.0, 0.0, 0.0),
)  # fmt: skip
SIDE_KICK = posed(leftUpperLeg=(-30.0, -20.0, 50.0), leftLowerLeg=(60.0, 0.0, 0.0))
LUNGE = posed(
    leftUpperLeg=(-90.0, 0.0, 0.0), leftLowerLeg=(100.0, 0.0, 0.0), leftFoot=(-12.0, 0.0, 0.0),
    rightUpperLeg=(25.0, 0.0, 0.0), rightLowerLeg=(70.0, 0.0, 0.0), rightFoot=(-35.0, 0.0, 0.0),
)  # fmt: skip
OVER_THE_SHOULDER = posed(
    neck=(0.0, 40.0, 0.0), head=(0.0, 40.0, 0.0), spine=(0.0, 14.0, 0.0), chest=(0.0, 14.0, 0.0),
    upperChest=(0.0, 14.0, 0.0),
)  # fmt: skip
NOD = posed(neck=(25.0, 0.0, 0.0), head=(25.0, 0.0, 0.0))


@pytest.mark.parametrize(
    "pose", [SQUAT, KNEES_APART, KICK, SIDE_KICK, LUNGE, OVER_THE_SHOULDER, NOD]
)
def test_what_people_do_is_within_the_limits(pose: Floats) -> None:
    assert excess_deg(pose) == 0.0


@pytest.mark.parametrize(
    "pose",
    [
        posed(leftLowerLeg=(-30.0, 0.0, 0.0)),  # a knee bent forwards
        posed(leftLowerLeg=(0.0, 0.0, 35.0)),  # and sideways
        posed(leftUpperLeg=(70.0, 0.0, 0.0)),  # a straight leg up behind
        posed(leftUpperLeg=(0.0, 0.0, -70.0)),  # a leg through the other
        posed(leftUpperLeg=(0.0, 130.0, 0.0)),  # toes to the back
        posed(leftFoot=(-80.0, 0.0, 0.0)),  # toes on the shin
        posed(leftFoot=(0.0, 0.0, 60.0)),
        posed(neck=(0.0, 70.0, 0.0), head=(0.0, 70.0, 0.0)),  # an owl
        posed(neck=(0.0, 0.0, 45.0), head=(0.0, 0.0, 45.0)),
    ],
)
def test_what_nobody_does_is_beyond_them(pose: Floats) -> None:
    assert excess_deg(pose) > 15.0
