"""A webcam that was plugged in elsewhere: asked about once, and remembered."""

from dataclasses import replace
from pathlib import Path

import pytest

from mocapd.calibration.calibration_file import calibration_path, read_calibration
from mocapd.capture.webcam.identity import WebcamIdentity, parse_identity
from mocapd.capture.webcam.webcam_listing import CameraInfo
from mocapd.errors import InputError, UnavailableError
from mocapd.wizard.cameras.initial_cameras import plugged_cameras, where_now
from mocapd.wizard.cameras.same_port import AsksForPorts, find_port_changes
from mocapd.wizard.commands import Command
from mocapd.wizard.context import Context
from mocapd.wizard.draft import Draft
from mocapd.wizard.saving import save_draft
from mocapd.wizard.step import StepState, StepView
from mocapd.wizard.step_commands import CAMERAS, Lock
from mocapd.wizard.step_names import StepName
from tests.wizard.context import FakeContext, do
from tests.wizard.drafts import full_draft, source_of

STAYED = source_of("cam0", "1-1")
MOVED = source_of("cam1", "2-4")


def present(*sources: str) -> list[WebcamIdentity]:
    return [parse_identity(source) for source in sources]


def info(source: str, problem: str = "") -> CameraInfo:
    return CameraInfo(
        Path("/dev/video0"), "a webcam", parse_identity(source), source, (), problem, "mend it"
    )


class Done:
    """The step Cameras, done."""

    name = StepName.CAMERAS
    verbs = CAMERAS

    def __init__(self, _context: Context) -> None:
        self.told: list[Command] = []

    def enter(self) -> None: ...
    def leave(self) -> None: ...
    def tick(self, now_ns: int) -> None: ...
    def job_failed(self, error: Exception) -> None: ...

    def command(self, command: Command) -> None:
        self.told.append(command)

    def view(self) -> StepView:
        return StepView(StepState.DONE, "Go on.", 1.0, details={"cameras": []})


def asking(folder: Path) -> tuple[FakeContext, AsksForPorts]:
    """With a calibration saved, and cam1 in another port than there."""
    draft = full_draft()
    context = FakeContext(folder, draft)
    save_draft(draft, context.state_dir)
    moved = list(find_port_changes(draft.cameras, present(STAYED, MOVED)))
    return context, AsksForPorts(context, Done, moved)


def test_a_camera_in_another_port_is_asked_about_and_remembered(tmp_path: Path) -> None:
    context, step = asking(tmp_path)
    view = step.view()
    assert view.state is StepState.WAITING
    assert "1-2" in view.problems[0].what
    assert "2-4" in view.problems[0].what
    do(step, "same_port", {"camera": "cam1", "same": True})
    assert step.view().state is StepState.DONE
    assert not step.view().problems
    saved = read_calibration(calibration_path(context.state_dir))
    assert [camera.source for camera in saved.camera] == [STAYED, MOVED]
    assert [camera.source for camera in context.draft.cameras] == [STAYED, MOVED]
    assert context.draft.rig is not None
    assert not find_port_changes(context.draft.cameras, present(STAYED, MOVED))


def test_another_camera_in_its_place_is_calibrated_anew(tmp_path: Path) -> None:
    context, step = asking(tmp_path)
    before = (context.state_dir / "calibration.toml").read_bytes()
    do(step, "same_port", {"camera": "cam1", "same": False})
    assert context.draft.rig is None
    assert set(context.draft.intrinsics) == {"cam0"}
    assert set(context.draft.colours) == {"cam0"}
    assert (context.state_dir / "calibration.toml").read_bytes() == before


def test_nothing_else_is_answered_and_the_rest_is_the_steps_own(tmp_path: Path) -> None:
    _, step = asking(tmp_path)
    with pytest.raises(InputError):
        do(step, "same_port", {"camera": "cam0", "same": True})
    do(step, "lock", {"camera": "cam0"})
    assert isinstance(step.inner, Done)
    assert step.inner.told == [Lock(camera="cam0")]


def test_who_is_not_plugged_in_or_may_be_a_twin_is_not_asked_about() -> None:
    draft = full_draft()
    assert not find_port_changes(draft.cameras, present(STAYED))
    twins = [source_of("cam1", "2-4"), source_of("cam1", "2-5")]
    assert not find_port_changes(draft.cameras, present(STAYED, *twins))


def test_cameras_keep_their_names_and_new_ones_get_free_ones() -> None:
    draft: Draft = replace(full_draft())
    infos = [info(MOVED), info(source_of("new", "3-1")), info(source_of("broken", "3-2"), "busy")]
    found = plugged_cameras(infos, draft.cameras)
    assert [(one.id, one.source) for one in found] == [
        ("cam1", MOVED),
        ("cam2", source_of("new", "3-1")),
    ]
    assert found[0].size_px == draft.cameras[1].size_px
    assert [one.source for one in where_now(draft.cameras, infos)] == [STAYED, MOVED]
    with pytest.raises(UnavailableError, match=r"busy.*mend it"):
        plugged_cameras(infos[2:], ())
