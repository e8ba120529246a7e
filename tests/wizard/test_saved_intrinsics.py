"""Intrinsics of earlier setups: of which camera and mode they are, how they are kept, and what damage says."""

import os
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from mocapd.calibrate.intrinsics.intrinsics import Intrinsics
from mocapd.errors import ConfigError
from mocapd.wizard.draft import Draft, DraftCamera
from mocapd.wizard.intrinsics.intrinsics_step import IntrinsicsStep
from mocapd.wizard.intrinsics.saved_intrinsics import (
    FILE_NAME,
    find_saved_intrinsics,
    read_intrinsics,
    store_intrinsics,
)
from mocapd.wizard.step import StepState
from tests.wizard.board_pictures import (
    RIG,
    SPEC,
)
from tests.wizard.context import FakeContext, do

WEBCAM = DraftCamera("cam0", "usb:1-3:046d:0825:5F2A", (640, 480))
LENS = Intrinsics(
    (640, 480),
    RIG[0].K,
    RIG[0].dist,
    np.array([True, True, True, True, False]),
    0.2,
    0.25,
    tuple(range(12)),
    (),
    0.002,
)
WHEN = datetime(2026, 11, 20, 9, 30, tzinfo=UTC)


def test_a_lens_is_offered_to_the_camera_that_it_was_measured_of(tmp_path: Path) -> None:
    context = FakeContext(tmp_path, Draft(cameras=(WEBCAM,), board=SPEC))
    store_intrinsics(replace(context.draft, intrinsics={"cam0": LENS}), context.state_dir, WHEN)
    moved = replace(WEBCAM, id="left", source="usb:2-1:046d:0825:5F2A")
    context = FakeContext(tmp_path, Draft(cameras=(moved,), board=SPEC))
    step = IntrinsicsStep(context)
    step.enter()
    cameras = step.view().details["cameras"]
    assert isinstance(cameras, dict)
    assert cameras["left"]["offered"]["when"] == "2026-11-20"
    assert step.view().state is StepState.WAITING
    do(step, "use_saved", {"camera": "left"})
    assert step.view().state is StepState.DONE
    np.testing.assert_allclose(context.draft.intrinsics["left"].K, RIG[0].K, rtol=1e-6)
    np.testing.assert_allclose(context.draft.intrinsics["left"].dist, RIG[0].dist, atol=1e-6)
    assert len(context.draft.intrinsics["left"].views) == 12
    assert context.draft.intrinsics_saved == {"left"}
    do(step, "measure", {"camera": "left"})
    assert step.view().state is StepState.WAITING


def test_saved_lenses_are_of_one_camera_and_one_mode(tmp_path: Path) -> None:
    draft = Draft(cameras=(WEBCAM,), intrinsics={"cam0": LENS})
    store_intrinsics(draft, tmp_path, WHEN)
    saved = read_intrinsics(tmp_path)
    assert find_saved_intrinsics(WEBCAM, saved) is not None
    assert find_saved_intrinsics(replace(WEBCAM, size_px=(1280, 720)), saved) is None
    assert find_saved_intrinsics(replace(WEBCAM, source="usb:1-3:046d:0825:other"), saved) is None
    assert find_saved_intrinsics(replace(WEBCAM, source="/dev/video0"), saved) is None
    text = (tmp_path / FILE_NAME).read_text()
    assert 'camera = "046d:0825:5F2A"' in text
    assert "size_px = [640, 480]" in text


def test_of_identical_webcams_none_gets_the_lens_of_the_other(tmp_path: Path) -> None:
    twins = [replace(WEBCAM, id=port, source=f"usb:{port}:046d:0825:") for port in ("1-3", "1-4")]
    lenses = {"1-3": LENS, "1-4": replace(LENS, K=LENS.K * np.array([[1.05], [1.05], [1.0]]))}
    store_intrinsics(Draft(cameras=tuple(twins), intrinsics=lenses), tmp_path, WHEN)
    saved = read_intrinsics(tmp_path)
    assert len(saved) == 2
    assert [find_saved_intrinsics(twin, saved) for twin in twins] == [None, None]


def test_storing_replaces_the_same_and_keeps_the_others(tmp_path: Path) -> None:
    other = replace(WEBCAM, id="cam1", source="usb:1-4:046d:0825:77")
    draft = Draft(cameras=(WEBCAM, other), intrinsics={"cam0": LENS, "cam1": LENS})
    store_intrinsics(draft, tmp_path, WHEN)
    better = replace(LENS, rms_px=0.1)
    store_intrinsics(replace(draft, intrinsics={"cam0": better, "cam1": LENS}), tmp_path, WHEN)
    assert sorted(one.rms_px for one in read_intrinsics(tmp_path)) == [0.1, 0.2]
    # a lens that was taken over is not stored as new
    worse = replace(draft, intrinsics={"cam0": LENS}, intrinsics_saved=frozenset({"cam0"}))
    store_intrinsics(worse, tmp_path, WHEN)
    assert sorted(one.rms_px for one in read_intrinsics(tmp_path)) == [0.1, 0.2]


@pytest.mark.parametrize("text", ["schema = ", "schema = 9", 'schema = 1\nlens = "none"'])
def test_a_damaged_file_of_lenses_is_told_and_the_step_goes_on(tmp_path: Path, text: str) -> None:
    context = FakeContext(tmp_path, Draft(cameras=(WEBCAM,), board=SPEC))
    (context.state_dir / FILE_NAME).write_text(text)
    with pytest.raises(ConfigError, match=FILE_NAME):
        read_intrinsics(context.state_dir)
    view = IntrinsicsStep(context).view()
    assert FILE_NAME in view.problems[0].where
    assert view.state is StepState.WAITING


@pytest.mark.parametrize(
    ("was", "becomes"),
    [
        ("views = 12", "views = 1000000000000"),
        ("views = 12", "views = 1.5"),
        ("rms_px = 0.2", "rms_px = nan"),
        ("rms_px = 0.2", "rms_px = -1.0"),
        ("focal_deviation = 0.002", "focal_deviation = inf"),
        ("size_px = [640, 480]", "size_px = [640, 0]"),
        ("size_px = [640, 480]", f"size_px = [640, {'9' * 5000}]"),
        ("[614.5", "[-614.5"),
        ("schema = 1", f"schema = 1\nx = {'[' * 600}{']' * 600}"),
    ],
)
def test_numbers_that_cannot_be_are_damage(tmp_path: Path, was: str, becomes: str) -> None:
    store_intrinsics(Draft(cameras=(WEBCAM,), intrinsics={"cam0": LENS}), tmp_path, WHEN)
    path = tmp_path / FILE_NAME
    text = path.read_text()
    assert was in text
    path.write_text(text.replace(was, becomes))
    with pytest.raises(ConfigError, match=FILE_NAME):
        read_intrinsics(tmp_path)


def test_a_file_of_lenses_that_is_none_is_told(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / FILE_NAME)  # opening it would wait for a writer
    with pytest.raises(ConfigError, match="no regular file"):
        read_intrinsics(tmp_path)
