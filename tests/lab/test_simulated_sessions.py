"""Sessions of real clips: how a clip is read and done by another body, and which sessions are planned."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lab.simulated.motion_clip import Placement, performed, read_clip, within
from lab.simulated.plain_plan import PLAIN_SESSIONS
from lab.simulated.recorded_set import SCENES, check_suits, failures, planned
from lab.simulated.session_plan import SECONDS, SESSIONS, PlannedSession, plan
from mocapd.assets import asset_path
from mocapd.body.bones import NAMES, PARENT_OF
from mocapd.body.skeleton import INDEX, joint_positions, standard_skeleton
from mocapd.errors import ConfigError, InputError
from mocapd.geometry import rotations
from mocapd.sim.scenario import load_scenario
from mocapd.sim.world import World, rig_of
from mocapd.types import Floats
from tests.sim.small import scenario

RATE_HZ, FRAMES = 60.0, 480
STATURE_M = 1.6


def walking(far_m: float = 0.5) -> dict[str, object]:
    """A clip of somebody who walks so far along +X and raises the left arm, without fingers or toes."""
    names = [name for name in NAMES if not name.endswith("Toes")]
    rest = standard_skeleton(STATURE_M).rest_m
    offsets = [
        rest[INDEX[n]] - (rest[INDEX[PARENT_OF[n]]] if n in PARENT_OF else 0.0) for n in names
    ]
    quats = np.tile(rotations.IDENTITY_XYZW, (FRAMES, len(names), 1))
    raised = rotations.exp(np.linspace(0.0, 1.2, FRAMES)[:, None] * np.array([0.0, 0.0, 1.0]))
    for bone in ("UpperArm", "LowerArm", "Hand"):
        quats[:, names.index("left" + bone)] = raised
    hips = np.tile(rest[0], (FRAMES, 1))
    hips[:, 0] += np.linspace(0.0, far_m, FRAMES)
    return {
        "fps": RATE_HZ, "names": names, "rest_offsets": np.array(offsets), "global_quats": quats, "hips_pos": hips,
    }  # fmt: skip


def clip_file(folder: Path, name: str = "walk", **fields: Any) -> Path:
    path = folder / f"{name}.npz"
    arrays: dict[str, Any] = {**walking(), **fields}
    np.savez(path, **arrays)
    return path


def hips_and_hand(path: Path, where: Placement, stature_m: float, t_s: float) -> Floats:
    skeleton = standard_skeleton(stature_m)
    joints = joint_positions(skeleton, performed(read_clip(path), where)(skeleton)(t_s))
    return joints[[INDEX["hips"], INDEX["leftHand"]]]


def test_a_clip_is_done_by_a_body_of_any_size(tmp_path: Path) -> None:
    path = clip_file(tmp_path)
    where = Placement(0, FRAMES, 0.0, 0.0, 0.1)
    for stature_m in (STATURE_M, 1.9):
        size = stature_m / STATURE_M
        first, last = (hips_and_hand(path, where, stature_m, t_s) for t_s in (0.1, 9.0))
        np.testing.assert_allclose(last[0] - first[0], [0.5 * size, 0.0, 0.0], atol=1e-6)
        # the middle of the way is where the cameras look
        np.testing.assert_allclose((last[0] + first[0])[[0, 2]], 0.0, atol=1e-6)
        skeleton = standard_skeleton(stature_m)
        arm_m = skeleton.rest_m[INDEX["leftHand"]] - skeleton.rest_m[INDEX["leftUpperArm"]]
        raised_m = (last[1] - last[0])[1] - (first[1] - first[0])[1]
        assert raised_m == pytest.approx(np.sin(1.2) * np.linalg.norm(arm_m), abs=0.03)


def test_it_begins_in_the_t_pose_and_looks_where_it_is_told(tmp_path: Path) -> None:
    path = clip_file(tmp_path)
    where = Placement(0, FRAMES, 90.0, 0.5, 0.5)
    skeleton = standard_skeleton(STATURE_M)
    pose_at = performed(read_clip(path), where)(skeleton)
    np.testing.assert_allclose(pose_at(0.0).quats_xyzw, pose_at(0.5).quats_xyzw, atol=1e-9)
    hand, hips = (joint_positions(skeleton, pose_at(0.2))[INDEX[n]] for n in ("leftHand", "hips"))
    # facing +X, the left hand points to -Z
    assert hand[2] - hips[2] < -0.5
    assert abs(hand[0] - hips[0]) < 0.05
    # after the change-over the arms are the clip's, without a jump
    moved_m = [
        float(np.abs(joint_positions(skeleton, pose_at(t)) - joint_positions(skeleton, pose_at(t + 0.01))).max())
        for t in np.arange(0.0, 2.0, 0.01)
    ]  # fmt: skip
    assert max(moved_m) < 0.03


def test_where_a_clip_stays_in_one_place_is_found(tmp_path: Path) -> None:
    hips = np.asarray(walking()["hips_pos"]).copy()
    hips[:200, 2] += np.linspace(-5.0, 0.0, 200)  # comes from far away
    clip = read_clip(clip_file(tmp_path, hips_pos=hips))
    begin = within(clip, 3.0, 1.0)
    assert begin is not None
    assert 150 < begin <= 200
    assert within(clip, 7.9, 1.0) is None


@pytest.mark.parametrize(
    ("broken", "said"),
    [
        ({"fps": 0.0}, "no clip of a humanoid"),
        ({"hips_pos": np.zeros((3, 3))}, "no clip of a humanoid"),
        ({"names": [f"bone{i}" for i in range(len(NAMES))]}, "no clip of a humanoid"),
        ({"global_quats": np.full((FRAMES, 3, 4), np.nan)}, "no clip of a humanoid"),
    ],
)
def test_what_is_no_clip_is_named(tmp_path: Path, broken: Mapping[str, Any], said: str) -> None:
    path = clip_file(tmp_path, **broken)
    with pytest.raises(InputError, match=said) as told:
        read_clip(path)
    assert str(path) in str(told.value)


def test_a_file_that_is_none_or_lacks_a_field_is_named(tmp_path: Path) -> None:
    text = tmp_path / "text.npz"
    text.write_text("no archive")
    with pytest.raises(InputError, match="cannot be read"):
        read_clip(text)
    lacking = tmp_path / "lacking.npz"
    np.savez(lacking, fps=60.0)
    with pytest.raises(InputError, match="global_quats"):
        read_clip(lacking)


def test_the_sessions_differ_and_are_the_same_each_time(tmp_path: Path) -> None:
    for n in range(30):
        clip_file(tmp_path, f"clip{n:02d}")
    sessions = planned(tmp_path)
    assert len(sessions) == SESSIONS
    assert {len(s.scenario.cameras) for s in sessions} == {1, 2, 3, 4}
    assert len({s.scenario.body.stature_m for s in sessions}) > 20
    places = [s.where for s in sessions if s.where]
    assert len({where.yaw_deg for where in places}) > 5
    assert any(light.events for s in sessions for light in s.scenario.lights)
    assert [s.scenario for s in planned(tmp_path)] == [s.scenario for s in sessions]
    assert len(places) == SESSIONS
    assert all(where.begin + where.frames <= FRAMES for where in places)


def test_what_does_not_stay_in_one_place_is_not_used(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no clip of motion"):
        planned(tmp_path)
    with pytest.raises(InputError, match="no clip of motion"):
        planned(tmp_path / "nowhere")
    far = clip_file(tmp_path, hips_pos=walking(far_m=20.0)["hips_pos"])
    with pytest.raises(InputError, match="long enough and stays in one place"):
        planned(tmp_path)
    scenes = [load_scenario(asset_path("scenarios") / f"{name}.toml") for name in SCENES]
    assert plan([read_clip(far)], scenes) == []


def test_the_world_has_the_person_that_performs(tmp_path: Path) -> None:
    clip, where = read_clip(clip_file(tmp_path)), Placement(0, FRAMES, 0.0, 0.0, 0.1)
    world = World(scenario(), performed(clip, where))
    t_s = 0.5 * SECONDS
    state = world.at(t_s)
    wanted = performed(clip, where)(world.skeleton)(t_s)
    np.testing.assert_allclose(state.pose.quats_xyzw, wanted.quats_xyzw)


LEGS = ("kick", "squat", "jump", "hop", "walk")


def test_sessions_without_the_shirt_are_of_whole_bodies_and_many_rigs(tmp_path: Path) -> None:
    for n in range(30):
        clip_file(tmp_path, f"{LEGS[n % 5]}{n:02d}" if n % 3 == 0 else f"clip{n:02d}")
    sessions = planned(tmp_path, "plain")
    assert len(sessions) == PLAIN_SESSIONS >= 16
    assert [s.scenario for s in planned(tmp_path, "plain")] == [s.scenario for s in sessions]
    assert all(s.scenario.body.whole for s in sessions)
    assert {s.scenario.clothes.shirt for s in sessions} == {"plain"}
    assert {s.scenario.clothes.sleeves for s in sessions} == {"long", "short"}
    assert len({s.scenario.clothes.top_weave.pattern for s in sessions}) == 4
    assert {len(s.scenario.cameras) for s in sessions} == {2, 3, 4}
    assert len({s.scenario.body.stature_m for s in sessions}) > 15
    assert any(s.scenario.others for s in sessions)
    assert any(t.kind == "portrait" for s in sessions for t in s.scenario.room.things)
    of_legs = [s for s in sessions if s.clip and s.clip.name.startswith(LEGS)]
    assert len(of_legs) >= PLAIN_SESSIONS // 2


def _apart_m(session: PlannedSession) -> Floats:
    first, second = rig_of(session.scenario).cameras[:2]
    return first.R @ (first.R.T @ first.t_m - second.R.T @ second.t_m)


def test_a_stereo_pair_looks_one_way_from_twelve_centimetres_apart(tmp_path: Path) -> None:
    for n in range(20):
        clip_file(tmp_path, f"clip{n:02d}")
    pairs = [s for s in planned(tmp_path, "plain") if "_stereo_" in s.name]
    assert len(pairs) >= 8
    for session in (*pairs, *(s for s in failures() if "_stereo_" in s.name)):
        first, second = rig_of(session.scenario).cameras
        # rolled, the bar lies a little askew in the first camera's axes
        assert np.linalg.norm(_apart_m(session)) == pytest.approx(0.12, abs=1e-9)
        assert _apart_m(session)[0] > 0.119
        np.testing.assert_allclose(first.R, second.R, atol=1e-9)
        assert not any(camera.clock_offset_s for camera in session.scenario.cameras)
    wide = [s for s in planned(tmp_path, "plain") if "_pair_" in s.name]
    assert all(np.linalg.norm(_apart_m(s)) > 1.5 for s in wide)


def test_a_clip_keeps_the_lower_ankle_as_high_as_it_was(tmp_path: Path) -> None:
    """Somebody who squats: the hips fall with the knees' bend, for legs of the clip's proportions."""
    names = [name for name in NAMES if not name.endswith("Toes")]
    bend = 0.9 * np.sin(np.linspace(0.0, np.pi, FRAMES))
    quats = np.tile(rotations.IDENTITY_XYZW, (FRAMES, len(names), 1))
    about_x = bend[:, None] * np.array([1.0, 0.0, 0.0])
    for side in ("left", "right"):
        quats[:, names.index(side + "UpperLeg")] = rotations.exp(-about_x)
        quats[:, names.index(side + "LowerLeg")] = rotations.exp(about_x)
    rest = standard_skeleton(STATURE_M).rest_m
    hip, ankle = rest[INDEX["leftUpperLeg"], 1], rest[INDEX["leftFoot"], 1]
    hips = np.tile(rest[0], (FRAMES, 1))
    hips[:, 1] -= (hip - ankle) * (1.0 - np.cos(bend))
    clip = read_clip(clip_file(tmp_path, global_quats=quats, hips_pos=hips))
    np.testing.assert_allclose(clip.ankle_m, clip.ankle_m[0], atol=1e-3)
    where = Placement(0, FRAMES, 0.0, 0.0, 0.1)
    world = World(
        scenario(body={"whole": True, "thigh_length": 1.15, "shank_length": 0.9}),
        performed(clip, where),
    )
    heights = [world.at(t).joints_m[INDEX["leftFoot"], 1] for t in np.arange(0.2, 8.0, 0.3)]
    np.testing.assert_allclose(heights, world.skeleton.rest_m[INDEX["leftFoot"], 1], atol=2e-3)


def test_a_session_may_begin_with_hanging_arms(tmp_path: Path) -> None:
    skeleton = standard_skeleton(STATURE_M)
    where = Placement(0, FRAMES, 0.0, 0.5, 0.1, "relaxed")
    pose = performed(read_clip(clip_file(tmp_path)), where)(skeleton)(0.2)
    joints = joint_positions(skeleton, pose)
    for side in ("left", "right"):
        hand, shoulder = joints[INDEX[side + "Hand"]], joints[INDEX[side + "UpperArm"]]
        assert shoulder[1] - hand[1] > 0.25 * STATURE_M


@pytest.mark.parametrize("session", failures(), ids=lambda session: session.name)
def test_a_scene_of_a_failure_is_possible_and_ends_in_the_open(session: PlannedSession) -> None:
    world, loop_s = World(session.scenario), session.scenario.loop_s
    times = np.arange(0.0, loop_s + 0.5, 1.0 / 60.0)
    joints = np.stack([world.at(float(t)).joints_m for t in times])
    speed = np.linalg.norm(np.diff(joints, axis=0), axis=2).max() * 60.0
    assert speed < 8.0
    assert 0.0 < joints[..., 1].min() < 0.12
    np.testing.assert_allclose(world.at(0.0).joints_m, world.at(loop_s).joints_m, atol=1e-9)
    if session.clear_s is None:
        return
    # two seconds are left in which a tracker can be right again, and the person then looks this way
    assert session.clear_s + 2.0 < loop_s
    for t in np.arange(session.clear_s + 0.1, loop_s - 0.3, 0.2):
        ahead = rotations.to_matrix(world.pose(float(t)).quats_xyzw[0])[:, 2]
        assert ahead[2] > 0.9


def test_what_follows_the_shirt_is_refused_where_nobody_wears_it(tmp_path: Path) -> None:
    sessions = failures()
    folders = [tmp_path / one.name for one in sessions]
    check_suits("canned", sessions, folders)
    check_suits("shirt", sessions[-1:], folders[-1:])  # in the shirt, under a jacket for a while
    with pytest.raises(ConfigError, match="which nobody wears in 12 of") as told:
        check_suits("shirt", sessions, folders)
    assert str(tmp_path) in str(told.value)
