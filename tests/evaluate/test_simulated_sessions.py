"""Sessions of real clips: how a clip is read and done by another body, and which sessions are planned."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mocapd.assets import asset_path
from mocapd.body.bones import NAMES, PARENT_OF
from mocapd.body.skeleton import INDEX, joint_positions, standard_skeleton
from mocapd.errors import InputError
from mocapd.evaluate.simulated.motion_clip import Placement, performed, read_clip, within
from mocapd.evaluate.simulated.recorded_set import SCENES, planned
from mocapd.evaluate.simulated.session_plan import SECONDS, SESSIONS, plan
from mocapd.geometry import rotations
from mocapd.sim.scenario import load_scenario
from mocapd.sim.world import World
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
    assert len({s.where.yaw_deg for s in sessions}) > 5
    assert any(light.events for s in sessions for light in s.scenario.lights)
    assert [s.scenario for s in planned(tmp_path)] == [s.scenario for s in sessions]
    assert all(s.where.begin + s.where.frames <= FRAMES for s in sessions)


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
