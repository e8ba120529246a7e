"""The world is a pure function of time, its loop closes, and its people are possible."""

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mocapd.assets import asset_path
from mocapd.body.pose_space import upper_body
from mocapd.body.skeleton import INDEX, PARENTS, joint_positions, local_from_global
from mocapd.geometry.camera_model import project
from mocapd.sim.scenario import load_scenario
from mocapd.sim.world import World, light_levels, rig_of
from tests.body.soft_limits import soft_limit
from tests.sim.small import LAMP_OFF_S, LAMP_ON_S, scenario

TIMES = st.floats(0.0, 40.0)


@settings(max_examples=25)  # each builds two worlds
@given(TIMES, TIMES)
def test_same_time_same_world_whatever_was_asked_before(a: float, b: float) -> None:
    world, other = World(scenario()), World(scenario())
    world.at(b)
    first, again = world.at(a), other.at(a)
    assert np.array_equal(first.joints_m, again.joints_m)
    assert np.array_equal(first.pose.quats_xyzw, again.pose.quats_xyzw)
    assert np.array_equal(first.light_levels, again.light_levels)


@pytest.mark.parametrize("name", ["living_room", "outdoor", "gym_mono", "jacket"])
def test_the_loop_closes_without_a_jump(name: str) -> None:
    s = load_scenario(asset_path(f"scenarios/{name}.toml"))
    world = World(s)
    for t in (0.0, 0.31):
        assert np.allclose(world.at(t).joints_m, world.at(t + s.loop_s).joints_m, atol=1e-9)
    before, after = world.at(s.loop_s - 1e-4), world.at(s.loop_s + 1e-4)
    # nothing moves faster than 8 m/s, at the seam or elsewhere
    assert np.abs(before.joints_m - after.joints_m).max() < 8.0 * 2e-4
    steps = np.stack([world.at(float(t)).joints_m for t in np.arange(0.0, s.loop_s, 0.05)])
    assert np.linalg.norm(np.diff(steps, axis=0), axis=2).max() < 8.0 * 0.05
    assert np.array_equal(light_levels(s, 0.0), light_levels(s, s.loop_s))


def test_the_pose_gives_the_joints_and_keeps_the_bones_lengths() -> None:
    world = World(scenario())
    rest = world.skeleton.rest_m
    length = np.linalg.norm((rest - rest[PARENTS])[1:], axis=1)
    for t in np.linspace(0.0, 2.0, 9):
        state = world.at(float(t))
        assert np.allclose(joint_positions(world.skeleton, state.pose), state.joints_m)
        bones = (state.joints_m - state.joints_m[PARENTS])[1:]
        assert np.allclose(np.linalg.norm(bones, axis=1), length, atol=1e-9)
        assert (state.pose.quats_xyzw[:, 3] >= 0.0).all()


def test_a_t_pose_keyframe_is_the_t_pose_for_the_arms() -> None:
    joints = World(
        scenario(motion={"keyframes": [{"t_s": 0.0, "pose": "t_pose"}], "sway_deg": 0.0})
    )
    joints_m = joints.at(0.0).joints_m
    left = joints_m[[INDEX["leftUpperArm"], INDEX["leftLowerArm"], INDEX["leftHand"]]]
    assert np.ptp(left[:, 1]) < 1e-6
    assert np.ptp(left[:, 2]) < 1e-6
    assert (np.diff(left[:, 0]) > 0.2).all()  # her left is +X


def test_feet_stand_still_between_steps() -> None:
    still = World(scenario(motion={"keyframes": [{"t_s": 0.0, "pose": "arms_up"}]}))
    feet = np.stack([still.at(float(t)).joints_m[INDEX["leftFoot"]] for t in np.linspace(0, 2, 21)])
    assert np.ptp(feet, axis=0).max() < 1e-3


def test_lamp_levels_follow_the_events() -> None:
    s = scenario()
    assert light_levels(s, 0.1)[0] == 1.0
    assert light_levels(s, LAMP_OFF_S + 0.1)[0] == 0.0
    assert light_levels(s, LAMP_ON_S + 0.1)[0] == 1.0
    assert light_levels(s, LAMP_OFF_S + 0.1 + 3 * s.loop_s)[0] == 0.0
    assert light_levels(s, LAMP_OFF_S + 0.1)[1] == 1.0


def test_the_person_appears_when_the_scenario_says() -> None:
    world = World(scenario(person_appears_s=0.5))
    assert not world.at(0.49).person_present
    assert world.at(0.5).person_present


def test_cameras_look_at_their_target_with_y_down() -> None:
    for camera, spec in zip(rig_of(scenario()).cameras, scenario().cameras, strict=True):
        target = np.array(spec.look_at_m)
        at, above = project(camera, target), project(camera, target + [0.0, 0.3, 0.0])
        assert np.allclose(at, camera.K[:2, 2], atol=1e-6)
        assert above[1] < at[1] - 5
        assert np.linalg.det(camera.R) == pytest.approx(1.0)
        points = np.array([[0.1, 1.2, 0.2], [-0.5, 0.3, -0.4]])
        theirs, _ = cv2.projectPoints(points, camera.R, camera.t_m, camera.K, camera.dist)
        assert np.allclose(theirs[:, 0], project(camera, points), atol=1e-6)


@pytest.mark.parametrize("name", ["living_room", "outdoor", "gym_mono", "jacket"])
def test_shipped_motions_stay_within_the_limits_of_joints(name: str) -> None:
    s = load_scenario(asset_path(f"scenarios/{name}.toml"))
    world, limits = World(s), upper_body().limits
    for t in np.arange(0.0, s.loop_s, 0.2):
        local = local_from_global(world.skeleton, world.pose(float(t)).quats_xyzw)
        _, excess_rad, _ = soft_limit(limits, local)
        assert np.abs(excess_rad).max() < np.radians(2.0)
