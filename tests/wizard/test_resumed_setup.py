"""A setup whose process ended goes on in the next one's wizard."""

import threading
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import pytest

from mocapd.errors import MocapdError
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.wizard.cameras.camera_locks import CameraLocks
from mocapd.wizard.commands import Command, Verbs
from mocapd.wizard.context import Context
from mocapd.wizard.setup_keeper import FILE_NAME, SetupKeeper, read_draft
from mocapd.wizard.step import StepState, StepView
from mocapd.wizard.step_names import StepName
from mocapd.wizard.wizard import MakeStep, Wizard
from mocapd.wizard.wizard_view import WizardView
from tests.wizard.drafts import begun, drafted, same

WAIT_S = 120.0


class Find(Command, frozen=True):
    """What `full_draft` has."""


class Save(Command, frozen=True):
    """The draft is saved."""


class FindingStep:
    """Is done, and finds everything when it is told to."""

    verbs: Verbs = MappingProxyType({"find": Find, "save": Save})

    def __init__(self, context: Context, name: StepName) -> None:
        self.name, self._context = name, context

    def enter(self) -> None: ...
    def leave(self) -> None: ...
    def tick(self, now_ns: int) -> None: ...
    def job_failed(self, error: MocapdError) -> None: ...

    def command(self, command: Command) -> None:
        if isinstance(command, Find):
            self._context.draft = replace(drafted(), cameras=self._context.draft.cameras)
        else:
            self._context.on_saved()

    def view(self) -> StepView:
        return StepView(StepState.DONE, "Go on.", 1.0)


class Run:
    """A wizard over a state directory, as a host makes one."""

    def __init__(self, folder: Path) -> None:
        draft = begun(drafted())
        self.died: list[BaseException] = []
        self._marks = 0
        self.wizard = Wizard(
            FrameHub(["cam0", "cam1"]),
            {name: self.maker(name) for name in StepName},
            dict,
            folder,
            folder,
            self.died.append,
            draft=draft,
            keeper=SetupKeeper(folder, draft, CameraLocks(())),
        )
        self.wizard.start()

    @staticmethod
    def maker(name: StepName) -> MakeStep:
        return lambda context: FindingStep(context, name)

    def after(self, verb: str, **args: object) -> WizardView:
        """The view when this was taken."""
        self._marks += 1
        mark = f"mark {self._marks}"
        self.wizard.send(verb, args)
        self.wizard.send(mark)  # refused by every step
        return self.until(lambda what: mark in what)

    def refused(self, verb: str, **args: object) -> str:
        """Why it was refused."""
        self.wizard.send(verb, args)
        refused = self.until(lambda what: "mark" not in what).refused
        assert refused is not None
        return refused.what

    def until(self, is_it: Callable[[str], bool]) -> WizardView:
        """The first view with such a refusal."""
        view = self.wizard.view()
        for _ in range(400):
            if view.refused is not None and is_it(view.refused.what):
                return view
            view = self.wizard.newer(view.serial, WAIT_S)
        raise AssertionError(f"not seen; last: {view}")

    def stop(self) -> None:
        assert self.wizard.stop(WAIT_S)
        assert not self.died


def wait_for(path: Path, there: bool = True) -> None:
    """Until the file is there, or gone."""
    waited = threading.Event()
    for _ in range(500):
        if path.exists() is there:
            return
        waited.wait(0.01)
    raise AssertionError(f"{path} {'is not there' if there else 'stays'}")


def interrupted(folder: Path) -> None:
    """A setup that found everything, Lens shown last, and was killed: what is in the file is what was
    written as it went."""
    run = Run(folder)
    run.after("go", step="lens")
    run.after("find")
    wait_for(folder / FILE_NAME)
    while StepName.LENS not in read_draft(folder / FILE_NAME).done:
        wait_for(folder / FILE_NAME)
    data = (folder / FILE_NAME).read_bytes()
    run.stop()
    (folder / FILE_NAME).write_bytes(data)


def test_after_a_kill_the_next_setup_goes_on_where_it_was(tmp_path: Path) -> None:
    interrupted(tmp_path)
    run = Run(tmp_path)
    offered = run.wizard.newer(0, WAIT_S)
    kept = offered.view.details["kept"]
    assert isinstance(kept, dict)
    assert kept["done"] == ["cameras", "lens"]
    assert offered.step is StepName.CAMERAS
    assert offered.view.state is StepState.WAITING
    assert "unfinished" in run.refused("go", step="room")
    run.after("find")
    assert "unfinished" in run.refused("next")
    run.after("find")  # what is found before the choice does not take the place of what is kept
    view = run.after("resume")
    assert view.step is StepName.ROOM  # the first that is not done
    assert {StepName.CAMERAS, StepName.LENS} <= view.done
    assert "kept" not in view.view.details
    assert same(run.wizard.draft, drafted())
    assert "there is no unfinished setup" in run.refused("resume")
    run.stop()
    again = Run(tmp_path)  # nothing new was found: still the same one
    assert "kept" in again.wizard.newer(0, WAIT_S).view.details
    again.stop()


def test_begun_anew_what_was_kept_is_gone(tmp_path: Path) -> None:
    interrupted(tmp_path)
    run = Run(tmp_path)
    view = run.after("begin_anew")
    assert "kept" not in view.view.details
    assert not (tmp_path / FILE_NAME).exists()
    assert run.wizard.draft.rig is None
    run.stop()


def test_nothing_is_kept_of_what_is_saved_or_only_has_cameras(tmp_path: Path) -> None:
    run = Run(tmp_path)
    run.after("go", step="lens")
    assert not (tmp_path / FILE_NAME).exists()
    run.after("find")
    wait_for(tmp_path / FILE_NAME)
    run.after("save")
    assert not (tmp_path / FILE_NAME).exists()
    run.after("go", step="room")
    run.stop()
    assert not (tmp_path / FILE_NAME).exists()


def test_what_was_found_last_is_written_before_the_end(tmp_path: Path) -> None:
    run = Run(tmp_path)
    run.wizard.send("find")
    run.after("go", step="room")
    run.stop()
    assert same(read_draft(tmp_path / FILE_NAME).draft.factors, drafted().factors)


def test_where_nothing_can_be_written_the_setup_goes_on(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    blocked = tmp_path / "state"
    blocked.write_text("a file where the folder should be")
    run = Run(blocked)
    run.after("find")
    run.after("go", step="room")
    run.stop()
    assert caplog.text.count("the setup in progress cannot be stored") == 1
