"""A setup without a shirt: its steps are left out, what is needed instead is said, and the mind can be changed."""

from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, datetime
from itertools import count
from pathlib import Path

import numpy as np
import pytest

from mocapd.calibrate.verification.check_measure import Measure, MeasuringTracker
from mocapd.calibrate.verification.check_verdict import camera_verdict
from mocapd.calibrate.verification.delivery import Delivery
from mocapd.calibration.calibration_file import calibration_path, from_saved, read_calibration
from mocapd.calibration.calibration_record import Calibration, Wearer
from mocapd.capture.camera_link import CameraLink
from mocapd.errors import ConfigError, InputError
from mocapd.geometry import rotations
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.trackers.registry import Resources, build, measuring_tracker
from mocapd.tracking.tracker_inputs import wearer_shape
from mocapd.types import Rig
from mocapd.wizard.body.body_step import BodyStep
from mocapd.wizard.check.missing_inputs import missing_inputs
from mocapd.wizard.draft import Draft
from mocapd.wizard.extrinsics.extrinsics_step import ExtrinsicsStep
from mocapd.wizard.saving import load_draft, save_draft
from mocapd.wizard.setup_keeper import FILE_NAME, UnfinishedSetup, read_draft, write_draft
from mocapd.wizard.step import StepState
from mocapd.wizard.step_names import StepName, after_shirt
from mocapd.wizard.wizard import Wizard
from mocapd.wizard.wizard_view import WizardView
from tests.tracking.plain_film import plain_film
from tests.tracking.profiles import markerless_tracker
from tests.tracking.stepping import Stepping
from tests.wizard.context import FakeContext, do
from tests.wizard.drafts import full_draft
from tests.wizard.test_wizard import WAIT_S, ScriptedStep, make

_MARKS = count()
WITHOUT = (StepName.CAMERAS, StepName.BODY, StepName.CHECK)


@pytest.fixture
def wizard(tmp_path: Path) -> Iterator[Wizard]:
    """Four steps, of which one is about the shirt, and all was found before."""
    names = (StepName.CAMERAS, StepName.COLOUR, StepName.BODY, StepName.CHECK)
    died: list[BaseException] = []
    one = Wizard(
        FrameHub(["cam0", "cam1"]), {name: make(ScriptedStep, name) for name in names}, dict, tmp_path, tmp_path,
        died.append, draft=full_draft(),
    )  # fmt: skip
    one.start()
    yield one
    assert one.stop(WAIT_S)
    assert not died


def after(wizard: Wizard, verb: str, **args: object) -> WizardView:
    """The view once the command was taken."""
    wizard.send(verb, args)
    mark = f"mark{next(_MARKS)}"  # refused by every step
    wizard.send(mark)
    view = wizard.view()
    while view.refused is None or mark not in view.refused.what:
        view = wizard.newer(view.serial, WAIT_S)
    return view


def test_steps_about_the_shirt_are_left_out_and_come_back(wizard: Wizard) -> None:
    view = after(wizard, "wear", shirt=False)
    assert view.steps == WITHOUT
    assert not view.has_shirt
    assert view.step is StepName.CAMERAS
    after(wizard, "done")
    assert after(wizard, "next").step is StepName.BODY
    back = after(wizard, "wear", shirt=True)
    assert StepName.COLOUR in back.steps
    assert back.has_shirt
    # what was painted before is still there
    assert wizard.draft.colours.keys() == {"cam0", "cam1"}
    assert StepName.COLOUR in back.done


def test_who_says_so_in_the_step_about_colours_is_led_on(wizard: Wizard) -> None:
    after(wizard, "done")
    assert after(wizard, "next").step is StepName.COLOUR
    assert after(wizard, "wear", shirt=False).step is StepName.BODY


def test_a_step_that_has_nothing_to_do_with_it_goes_on(wizard: Wizard) -> None:
    after(wizard, "job", job=lambda tell: "so far")
    view = wizard.view()
    while view.view.details["happened"] == []:
        view = wizard.newer(view.serial, WAIT_S)
    assert after(wizard, "wear", shirt=False).view.details["happened"] == ["got so far"]


def test_whoever_has_a_shirt_after_all_is_asked_for_its_colours() -> None:
    names, bare = tuple(StepName), replace(full_draft(), colours={})
    assert after_shirt(StepName.CHECK, names, bare) is StepName.COLOUR
    assert after_shirt(StepName.CHECK, names, full_draft()) is StepName.CHECK
    assert after_shirt(StepName.LENS, names, bare) is None


def test_another_word_than_yes_or_no_is_refused(wizard: Wizard) -> None:
    wizard.send("wear", {"shirt": "perhaps"})
    view = wizard.view()
    while view.refused is None:
        view = wizard.newer(view.serial, WAIT_S)
    assert "was not said" in view.refused.what
    assert view.has_shirt


def test_the_height_is_asked_for_and_nothing_else_of_the_body(tmp_path: Path) -> None:
    draft = replace(full_draft(), has_shirt=False, stature_m=None, factors=None)
    context = FakeContext(tmp_path, draft)
    step = BodyStep(context)
    step.enter()
    assert step.view().state is StepState.WAITING
    do(step, "stature", {"m": 1.8})
    view = step.view()
    assert view.state is StepState.DONE
    assert view.details["can_measure"] is False
    assert "with the shirt" in str(view.details["why_not"])


def test_colours_are_not_missing_but_a_second_camera_is() -> None:
    draft = replace(full_draft(), has_shirt=False, colours={})
    assert not [*missing_inputs(draft)]
    assert draft.rig is not None
    alone = replace(draft, rig=Rig(draft.rig.cameras[:1]))
    assert ["second camera" in one.fix for one in missing_inputs(alone)] == [True]
    assert not [*missing_inputs(replace(alone, has_shirt=True, colours=full_draft().colours))]


def test_it_is_remembered_in_both_files(tmp_path: Path) -> None:
    draft = replace(full_draft(), has_shirt=False)
    save_draft(draft, tmp_path)
    path = calibration_path(tmp_path)
    assert not load_draft(tmp_path).has_shirt
    assert not from_saved(read_calibration(path), path).wearer.has_shirt
    write_draft(tmp_path / FILE_NAME, UnfinishedSetup(datetime.now(UTC), frozenset(), draft))
    assert not read_draft(tmp_path / FILE_NAME).draft.has_shirt


def test_a_file_that_does_not_say_is_of_somebody_with_a_shirt(tmp_path: Path) -> None:
    save_draft(replace(full_draft(), has_shirt=False), tmp_path)
    path = calibration_path(tmp_path)
    text = path.read_text()
    assert "has_shirt = false" in text
    path.write_text("".join(line for line in text.splitlines(True) if "has_shirt" not in line))
    assert load_draft(tmp_path).has_shirt


def test_without_a_shirt_auto_needs_no_pose_database_and_says_when_nothing_can_run() -> None:
    known = plain_film().known
    plain = Calibration(known.rig, Wearer(1.75, has_shirt=False))
    assert build("auto", plain, Resources()).name == "auto"
    assert measuring_tracker("auto", has_shirt=False) == "markerless"
    assert measuring_tracker("shirt", has_shirt=True) == "shirt"
    assert known.rig is not None
    alone = replace(plain, rig=Rig(known.rig.cameras[:1]))
    with pytest.raises(ConfigError, match="two of the calibrated cameras"):
        build("auto", alone, Resources())


@pytest.mark.kernels
def test_a_turned_camera_is_found_by_the_outline() -> None:
    film = plain_film()
    rig = film.known.rig
    assert rig is not None
    first, second = rig.cameras
    up = rotations.to_matrix(rotations.exp(np.array([np.radians(1.5), 0.0, 0.0])))
    turned = Rig((first, replace(second, R=up @ second.R, t_m=up @ second.t_m)))
    verdicts = []
    for one in (rig, turned):
        shape = wearer_shape(film.known)
        into: list[Measure] = []
        watched = MeasuringTracker(
            markerless_tracker(film.known), one, shape, into.append, by_outline=True
        )
        stepping = Stepping(watched, shape)
        for frames in film.frames:
            stepping.step(frames)
        every = Delivery(40, 0, 30.0, 30.0, CameraLink.PLAYER)
        verdicts.append(camera_verdict(second.name, into, every, 320, has_shirt=False))
    assert verdicts[0].match > 0.6
    assert verdicts[1].reprojection_px > verdicts[0].reprojection_px + 2.0
    assert verdicts[1].problem is not None
    assert "the body is seen" in verdicts[1].problem.what


def test_a_draft_has_a_shirt_unless_it_says_otherwise() -> None:
    assert Draft().has_shirt


def test_a_room_without_a_board_is_not_offered(tmp_path: Path) -> None:
    step = ExtrinsicsStep(FakeContext(tmp_path, replace(full_draft(), has_shirt=False)))
    step.enter()
    assert step.view().details["methods"] == ["board"]
    with pytest.raises(InputError, match="by the shirt"):
        do(step, "method", {"method": "wearer"})
