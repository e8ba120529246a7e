"""Scores of tracks whose errors are known, and agreement with the scorer of ../shared."""

import json
import math
import subprocess
import sys
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from mocapd.body.bones import NAMES
from mocapd.body.skeleton import INDEX
from mocapd.errors import InputError
from mocapd.evaluate.score import JOINT_SETS, interior_angle_deg, match, score
from mocapd.evaluate.truth import load_truth
from mocapd.session.offline import RecordedTrack, write_track
from tests.evaluate.tracks import EMPTY, FRAMES, moving_truth, track_of

SKIPPED = 15  # half a second


def test_the_truth_itself_scores_perfectly() -> None:
    truth = moving_truth()
    result = score(truth, track_of(truth))
    assert result.frames == FRAMES - EMPTY - SKIPPED
    assert result.coverage == 1.0
    assert result.ghost_frames == 0
    assert result.rms_cm == 0.0
    assert result.joint_angle_deg == pytest.approx(0.0, abs=1e-6)
    assert result.jitter_ratio == pytest.approx(1.0)


def test_a_shifted_body_has_an_error_and_no_angle_error() -> None:
    truth = moving_truth()
    result = score(truth, track_of(truth, 0.03))
    assert result.rms_cm == pytest.approx(3.0)
    assert result.median_cm == pytest.approx(3.0)
    assert result.joint_angle_deg == pytest.approx(0.0, abs=1e-6)


def test_the_error_of_one_joint_is_told_as_its_own() -> None:
    truth = moving_truth()
    error_m = np.zeros((FRAMES, len(NAMES)))
    error_m[:, INDEX["rightHand"]] = 0.08
    result = score(truth, track_of(truth, error_m))
    assert result.per_joint_rms_cm["rightHand"] == pytest.approx(8.0)
    assert result.per_joint_rms_cm["leftHand"] == 0.0
    assert result.rms_cm == pytest.approx(8.0 / np.sqrt(8.0))


def test_untracked_frames_lower_the_coverage_and_nothing_else() -> None:
    truth = moving_truth()
    keep = [f for f in range(EMPTY, FRAMES) if f % 5]
    result = score(truth, track_of(truth, 0.02, keep))
    assert result.coverage == pytest.approx(sum(f >= 25 for f in keep) / 45)
    assert result.rms_cm == pytest.approx(2.0)


def test_nan_joints_count_as_untracked() -> None:
    truth = moving_truth()
    track = track_of(truth)
    track.joints_m[20:30, INDEX["neck"]] = np.nan
    assert score(truth, track).coverage == pytest.approx(35 / 45)


def test_frames_with_a_person_in_the_empty_room_are_ghosts() -> None:
    truth = moving_truth()
    track = track_of(truth, keep=[10, *range(12, FRAMES)])
    ghostly = RecordedTrack(
        np.concatenate([truth.times_s[3:6], track.times_s]),
        NAMES,
        np.concatenate([track.joints_m[:3], track.joints_m]),
        np.concatenate([track.global_xyzw[:3], track.global_xyzw]),
        np.concatenate([track.confidence[:3], track.confidence]),
        np.concatenate([track.tracker[:3], track.tracker]),
    )
    assert score(truth, ghostly).ghost_frames == 3


def test_nobody_tracked_is_no_coverage_and_no_figures() -> None:
    truth = moving_truth()
    result = score(truth, track_of(truth, keep=[]))
    assert result.coverage == 0.0
    assert result.frames == 45
    assert np.isnan(result.rms_cm)
    assert np.isnan(result.joint_angle_deg)


def test_frames_match_by_time_within_half_a_frame() -> None:
    truth = moving_truth()
    track = track_of(truth)
    late = RecordedTrack(
        track.times_s + 0.010,
        NAMES, track.joints_m, track.global_xyzw, track.confidence, track.tracker,
    )  # fmt: skip
    matches = match(truth, late)
    assert np.array_equal(matches.truth_rows, matches.track_rows + EMPTY)
    alone = track_of(truth, keep=[40])
    assert match(truth, alone).truth_rows.tolist() == [40]


@pytest.mark.parametrize("joints", JOINT_SETS)
def test_every_set_of_joints_can_be_scored(joints: str) -> None:
    truth = moving_truth()
    result = score(truth, track_of(truth, 0.01), joints)
    assert result.rms_cm == pytest.approx(1.0)
    assert list(result.per_joint_rms_cm) == list(JOINT_SETS[joints])


def test_a_track_without_a_joint_is_an_error_that_names_it() -> None:
    truth = moving_truth()
    track = track_of(truth)
    armless = RecordedTrack(
        track.times_s, NAMES[:9], track.joints_m[:, :9],
        track.global_xyzw, track.confidence, track.tracker,
    )  # fmt: skip
    with pytest.raises(InputError, match="rightHand"):
        score(truth, armless)


def test_the_angle_of_an_elbow_bent_square() -> None:
    joints = np.array([[[1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 2.0, 0.0]]])
    assert interior_angle_deg(joints, ("a", "b", "c"), ("a", "b", "c")) == pytest.approx([90.0])


@pytest.mark.parametrize("joints", ["upper", "full"])
def test_it_tells_what_the_shared_scorer_tells(
    joints: str, dev_captures: Callable[[str], Path], shared_dir: Path, tmp_path: Path
) -> None:
    capture = dev_captures("pair_lampoff_basket")
    truth = load_truth(capture)
    rng = np.random.default_rng(3)
    error_m = rng.gamma(1.5, 0.02, truth.joints_m.shape[:2])
    seen = np.flatnonzero(truth.visible)
    keep = [int(f) for f in seen if f % 11]
    track = track_of(truth, error_m, keep)
    ghosts = truth.times_s[:4]
    track = RecordedTrack(
        np.concatenate([ghosts, track.times_s]),
        NAMES,
        np.concatenate([track.joints_m[:4], track.joints_m]),
        np.concatenate([track.global_xyzw[:4], track.global_xyzw]),
        np.concatenate([track.confidence[:4], track.confidence]),
        np.concatenate([track.tracker[:4], track.tracker]),
    )
    write_track(tmp_path / "track.npz", track)
    words = [shared_dir / "tools" / "score_track.py", capture, tmp_path / "track.npz", "--json"]
    done = subprocess.run(
        [sys.executable, *map(str, words), "--joints", joints],
        capture_output=True,
        text=True,
        check=True,
    )
    theirs, ours = json.loads(done.stdout), score(truth, track, joints)
    assert ours.ghost_frames == 4
    for key in (field.name for field in fields(ours)):  # theirs tells of more
        if key == "per_joint_rms_cm":
            assert ours.per_joint_rms_cm == pytest.approx(
                theirs[key], abs=0.0051
            )  # theirs are rounded
        else:
            mine = getattr(ours, key)
            told = 0.0 if math.isnan(mine) else mine  # of no joints at all they tell 0
            assert told == pytest.approx(theirs[key], rel=1e-9), key
