"""Check: what it asks for first, how it judges, and what Save does when it cannot."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mocapd.calibrate.verification.check_measure import CameraMeasure, Measure
from mocapd.calibrate.verification.check_verdict import (
    camera_verdict,
    room_problems,
    verdict_json,
)
from mocapd.calibrate.verification.delivery import Delivery, Grade
from mocapd.calibration.calibration_file import FILE_NAME
from mocapd.capture.camera_link import CameraLink
from mocapd.config.sections import TrackerSection
from mocapd.errors import InputError, Problem
from mocapd.pipeline.bundler import CameraCounts
from mocapd.pipeline.collector import CollectorCounts
from mocapd.pipeline.metrics import Metrics, MetricsRecorder
from mocapd.pipeline.slowness import Slowness
from mocapd.types import Rig, Tracking
from mocapd.wizard.check.check_settings import CheckSettings
from mocapd.wizard.check.check_step import CheckStep, Phase
from mocapd.wizard.check.missing_inputs import missing_inputs
from mocapd.wizard.draft import Draft
from mocapd.wizard.newest_body import NewestBody
from mocapd.wizard.saving import load_draft, save_draft
from mocapd.wizard.step import Scene, StepState
from tests.wizard.context import BEGIN_NS, TICK_NS, FakeContext, do
from tests.wizard.drafts import full_draft

pytestmark = pytest.mark.kernels

ALL_ARRIVE = Delivery(received=150, lost=0, rate_hz=29.9, asked_hz=30.0, link=CameraLink.USB)


def measures(
    shift_px: float = 0.5, match: float = 0.9, lean_rad: float = 0.1, hips_m: float = 0.9,
    scale: float = 1.0,
) -> list[Measure]:  # fmt: skip
    """Fifty frames, two of them with trouble."""
    out = []
    for i in range(50):
        away = np.array([shift_px if i > 1 else 50.0, 0.0])
        one = CameraMeasure(away, float(np.linalg.norm(away)) * 0.004, match)
        out.append(Measure({"cam0": one}, lean_rad, hips_m, np.full(3, scale)))
    return out


def check_step(context: FakeContext) -> CheckStep:
    def died(error: BaseException) -> None:
        raise error

    return CheckStep(context, CheckSettings(TrackerSection()), NewestBody(), died)


@pytest.mark.parametrize(
    ("changes", "delivery", "grade", "says"),
    [
        ({}, {}, Grade.GOOD, ""),
        ({"shift_px": 4.0}, {}, Grade.DOUBTFUL, "step Room"),
        ({"shift_px": 12.0}, {}, Grade.BAD, "step Room"),
        ({"shift_px": 4.0}, {"width_px": 1920}, Grade.DOUBTFUL, "cm"),
        ({"match": 0.5}, {}, Grade.DOUBTFUL, "step Colour"),
        ({"match": 0.2}, {}, Grade.BAD, "step Colour"),
        ({}, {"lost": 20}, Grade.DOUBTFUL, "USB port"),
        ({}, {"late": 20}, Grade.DOUBTFUL, "come too late"),
        ({}, {"rate_hz": 15.0}, Grade.DOUBTFUL, "15 pictures a second"),
    ],
)
def test_a_camera_is_judged_by_its_worst_figure(
    changes: dict[str, float], delivery: dict[str, Any], grade: Grade, says: str
) -> None:
    figures = {"width_px": 640} | delivery
    width_px = figures.pop("width_px")
    arrived = replace(ALL_ARRIVE, **figures)
    verdict = camera_verdict("cam0", measures(**changes), arrived, width_px)
    assert verdict.grade is grade
    if verdict.problem is None:
        assert grade is Grade.GOOD
    else:
        assert says in f"{verdict.problem.what} {verdict.problem.fix}"


def test_a_camera_that_saw_nobody_is_bad_and_has_no_figures() -> None:
    verdict = camera_verdict("cam1", measures(), ALL_ARRIVE, 640)
    assert verdict.grade is Grade.BAD
    assert verdict.visible_share == 0.0
    assert math.isnan(verdict.cm)
    assert verdict_json(verdict)["cm"] is None


@pytest.mark.parametrize(
    ("changes", "where"),
    [
        ({}, None),
        ({"lean_rad": 0.6}, "the floor"),
        ({"hips_m": 1.2}, "the floor"),
        ({"scale": 1.12}, "the scale"),
    ],
)
def test_a_room_that_contradicts_the_person_is_told(
    changes: dict[str, float], where: str | None
) -> None:
    found = room_problems(measures(**changes), hips_m=0.92, floor_known=True)
    assert [one.where for one in found] == ([where] if where else [])


def test_what_was_left_out_is_named_with_its_step(tmp_path: Path) -> None:
    assert [(one.what, one.where) for one in missing_inputs(Draft())] == [
        ("where the cameras stand is not known", "room"),
        ("the wearer's stature is not known", "body"),
    ]
    (colours,) = missing_inputs(replace(full_draft(), colours={}))
    assert colours.where == "colour"
    assert colours.what == "the shirt's colours in this light are not known"
    assert not [*missing_inputs(full_draft())]
    context = FakeContext(tmp_path, Draft())
    step = check_step(context)
    step.enter()
    assert step.view().state is StepState.FAILED
    assert context.job is None
    assert context.scenes == [Scene.MOVING]


def test_nothing_is_saved_before_it_is_judged(tmp_path: Path) -> None:
    context = FakeContext(tmp_path, full_draft())
    step = check_step(context)
    step.enter()
    assert step.view().state is StepState.WORKING
    for verb in ("save", "measure", "dance"):
        with pytest.raises(InputError):
            do(step, verb, {})
    step.leave()
    assert context.times_saved == 0


def test_a_place_that_cannot_be_written_is_told_and_can_be_mended(tmp_path: Path) -> None:
    context = FakeContext(tmp_path, full_draft())
    save_draft(replace(full_draft(), stature_m=1.5), context.state_dir)
    before = (context.state_dir / FILE_NAME).read_bytes()
    step = check_step(context)
    step._phase = Phase.JUDGED
    colours = context.state_dir / "colours"
    colours.rename(tmp_path / "away")
    colours.write_text("in the way")
    with pytest.raises(InputError, match="untouched"):
        do(step, "save", {})
    assert (context.state_dir / FILE_NAME).read_bytes() == before
    assert context.times_saved == 0
    colours.unlink()
    do(step, "save", {})
    assert context.times_saved == 1
    assert load_draft(context.state_dir).stature_m == 1.72
    assert step.view().details["saved"] == str(context.state_dir / FILE_NAME)


class LosingTracking:
    """Tracks a person while a fifth of each camera's frames is lost."""

    def __init__(self, rig: Rig, slowness: Slowness | None) -> None:
        self.rig, self._slowness, self._arrived = rig, slowness, 0

    def measures(self) -> list[Measure]:
        self._arrived += 8
        one = CameraMeasure(np.array([0.02, 0.0]), 0.002, 0.9)
        return [Measure(dict.fromkeys(self.rig.names, one), 0.1, 0.9, np.full(3, 1.0))]

    def counts(self) -> dict[str, CameraCounts]:
        counts = CameraCounts(self._arrived, self._arrived, 0, self._arrived // 4)
        return dict.fromkeys(self.rig.names, counts)

    def metrics(self) -> Metrics:
        recorder = MetricsRecorder()
        measured = recorder.snapshot(CollectorCounts(0, 0, {}, {}), BEGIN_NS)
        return replace(measured, tracking=Tracking.LIVE, slowness=self._slowness)


def judged(tmp_path: Path, slowness: Slowness | None) -> list[Problem]:
    """The problems of webcams that lose frames."""
    context = FakeContext(tmp_path, full_draft())
    step = check_step(context)
    rig = context.draft.rig
    assert rig is not None
    step._tracking = LosingTracking(rig, slowness)  # type: ignore[assignment]
    step._phase = Phase.SEEKING
    for _ in range(200):
        step.tick(context.now_ns)
        context.now_ns += TICK_NS
    assert step.view().details["phase"] == "judged"
    return list(step.view().problems)


def test_an_empty_room_that_takes_longer_leaves_the_bar_full(tmp_path: Path) -> None:
    context = FakeContext(tmp_path, full_draft())
    step = check_step(context)
    assert context.draft.rig is not None
    step._tracking = LosingTracking(context.draft.rig, None)  # type: ignore[assignment]
    step._phase = Phase.EMPTY
    for _ in range(200):
        step.tick(context.now_ns)
        context.now_ns += TICK_NS
    assert step.view().details["phase"] == "empty", "it has published no frame"
    assert step.view().progress == 1.0


def test_usb_is_blamed_for_what_webcams_lose_and_a_slow_machine_where_it_is_slow(
    tmp_path: Path,
) -> None:
    for one in judged(tmp_path / "fast", None):
        assert "another USB port" in one.fix, one.where
    *cameras, machine = judged(tmp_path / "slow", Slowness(0.5, 15.0, 30.0, 60.0, 0.6))
    assert "other programs use 60 % of this machine" in machine.what
    for one in cameras:
        assert one.what == "20 % of its frames are lost: this machine is too slow", "why: once"
        assert "close other programs" in one.fix
        assert "USB" not in one.fix
