"""Scores before cameras all around, of bodies made by hand."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from lab.pages import rings_page as page
from lab.simulated.motion_clip import read_clip
from lab.simulated.recorded_set import SCENES
from lab.simulated.ring_plan import RING_SESSIONS, ring_plan
from lab.studies.ring_scores import RingScore, exchanged_share
from mocapd.assets import asset_path
from mocapd.body.bones import NAMES
from mocapd.body.skeleton import INDEX, OTHER_SIDE, standard_skeleton
from mocapd.evaluate.truth import Truth
from mocapd.session.offline import RecordedTrack
from mocapd.sim.scenario import load_scenario
from tests.lab.test_simulated_sessions import clip_file

F = 60
SCORE = RingScore("squat-0123456789ab", 4, "", 1.0, 4.0, 3.0, 6.0, 2.0, 5.0, 0.25)


def test_legs_are_exchanged_where_each_is_nearer_to_the_other() -> None:
    legs = [INDEX[s + b] for s in ("left", "right") for b in ("UpperLeg", "LowerLeg", "Foot")]
    true_m = np.tile(standard_skeleton(1.75).rest_m, (F, 1, 1))
    found_m = true_m.copy()
    found_m[30:36, legs] = true_m[30:36][:, OTHER_SIDE[legs]]
    found_m[40:50, legs] += 0.3  # far away, but each in its place
    times_s = np.arange(F) / 30.0
    quats = np.tile([0.0, 0.0, 0.0, 1.0], (F, len(NAMES), 1))
    sure, by = np.ones((F, len(NAMES))), np.full(F, "clothes")
    truth = Truth(NAMES, times_s, true_m, np.ones(F, dtype=bool), None)
    track = RecordedTrack(times_s, NAMES, found_m, quats, sure, by)
    scored = F - 15  # half a second after the person came
    assert exchanged_share(truth, track) == pytest.approx(6 / scored)


def test_the_page_has_means_by_the_number_of_cameras_and_what_one_camera_less_costs() -> None:
    three = replace(SCORE, name="kick-0123456789ab", cameras=3, rms_cm=6.0)
    sessions = page.sessions_table([SCORE, replace(SCORE, rms_cm=5.0), three])
    assert "| mean of 2 with 4 cameras |    1.000 |     4.5 |" in sessions
    assert "| mean of 1 with 3 cameras |    1.000 |     6.0 |" in sessions
    assert "25.0 %" in sessions
    without = [replace(SCORE, left_out=f"cam{k}", rms_cm=4.0 + k) for k in range(3)]
    assert (
        "| mean without one camera, relative to all cameras |          |    1.25 |"
        in page.left_out_table([SCORE, *without])
    )


def test_the_sessions_have_three_and_four_cameras_around_and_a_second_person_in_some(
    tmp_path: Path,
) -> None:
    words = ("kick", "squat", "deposit", "jog", "jumping", "throw", "other")
    clips = [read_clip(clip_file(tmp_path, f"{word}{n}")) for word in words for n in range(3)]
    scenes = [load_scenario(asset_path("scenarios") / f"{name}.toml") for name in SCENES]
    sessions = ring_plan(clips, scenes)
    assert len(sessions) == RING_SESSIONS
    assert [len(one.scenario.cameras) for one in sessions] == [3, 4] * (RING_SESSIONS // 2)
    assert 2 <= sum(bool(one.scenario.others) for one in sessions) <= 6
    assert not any("other" in one.name for one in sessions)
    for one in sessions:
        places = np.array([camera.position_m for camera in one.scenario.cameras])[:, [0, 2]]
        bearings = np.sort(np.arctan2(places[:, 0], places[:, 1]))
        gaps = np.diff(np.append(bearings, bearings[0] + 2.0 * np.pi))
        assert gaps.max() < np.radians(135.0), "somebody stands between them"
