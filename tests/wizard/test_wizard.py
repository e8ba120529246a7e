"""Which step is shown, what becomes of commands and jobs, and what others see of it."""

import threading
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import cv2
import numpy as np
import pytest

from mocapd.errors import ConfigError, InputError, MocapdError
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.types import Camera, Rig
from mocapd.wizard.commands import Command
from mocapd.wizard.context import Context
from mocapd.wizard.draft import Draft, DraftCamera
from mocapd.wizard.step import Json, Scene, StepState, StepView, Tell
from mocapd.wizard.step_names import StepName
from mocapd.wizard.wizard import Wizard
from mocapd.wizard.wizard_view import WizardView

WAIT_S = 120.0
CAMERA = DraftCamera("cam0", "sim:cam0", (640, 480))
PLACED = Camera("cam0", (640, 480), np.eye(3), np.zeros(5), np.eye(3), np.zeros(3))


class Done(Command, frozen=True):
    """The step is done."""


class FindRig(Command, frozen=True):
    """The draft has a rig, and the step is done."""


class Job(Command, frozen=True):
    """Start this job."""

    job: Any


class SaveIt(Command, frozen=True):
    """The draft is saved."""


class Raise(Command, frozen=True):
    """Raise this."""

    error: Any


class RaiseInTick(Raise, frozen=True):
    """Raise this in the next tick."""


class ScriptedStep:
    """A step that does what a test tells it by commands, and shows what happened."""

    verbs = MappingProxyType(
        {
            "done": Done,
            "find_rig": FindRig,
            "job": Job,
            "save": SaveIt,
            "raise": Raise,
            "raise_in_tick": RaiseInTick,
        }
    )

    def __init__(self, context: Context, name: StepName) -> None:
        self.name = name
        self.context = context
        self.state = StepState.WAITING
        self.said = ""
        self.happened: list[str] = []
        self.error: BaseException | None = None

    def enter(self) -> None:
        self.context.scene(Scene.EMPTY)

    def tick(self, now_ns: int) -> None:
        error, self.error = self.error, None
        if error is not None:
            raise error
        job = self.context.job
        self.said = job[0] if job else ""

    def command(self, command: Command) -> None:
        match command:
            case Done():
                self.state = StepState.DONE
            case FindRig():
                self.context.draft = replace(self.context.draft, rig=Rig((PLACED,)))
                self.state = StepState.DONE
            case Job(job=job):
                self.context.start_job(job, lambda result: self.happened.append(f"got {result}"))
            case SaveIt():
                self.context.on_saved()
            case Raise(error=error):
                raise error
            case RaiseInTick(error=error):
                self.error = error

    def job_failed(self, error: MocapdError) -> None:
        self.happened.append(f"failed: {error.what}")

    def view(self) -> StepView:
        return StepView(
            self.state,
            self.said,
            details={"happened": list(self.happened)},
            pictures={f"{self.name}/1": b"png"},
        )

    def leave(self) -> None:
        pass


class RoomWithoutLenses(ScriptedStep):
    """Cannot be begun."""

    def __init__(self, context: Context, name: StepName) -> None:
        raise InputError("no lens is known", "room", "do the step Lens first")


def make(kind: type[ScriptedStep], name: StepName) -> Callable[[Context], ScriptedStep]:
    return lambda context: kind(context, name)


class Run:
    """A wizard of three steps that runs."""

    def __init__(self, folder: Path, draft: Draft | None = None) -> None:
        self.died: list[BaseException] = []
        self.died_event = threading.Event()
        self.scenes: list[Scene] = []
        self.saved = 0
        self.wizard = Wizard(
            FrameHub(["cam0"]),
            {
                StepName.CAMERAS: make(ScriptedStep, StepName.CAMERAS),
                StepName.ROOM: make(RoomWithoutLenses, StepName.ROOM),
                StepName.CHECK: make(ScriptedStep, StepName.CHECK),
            },
            dict,
            folder,
            folder,
            self.hear_of_death,
            self.scenes.append,
            draft=draft or Draft(cameras=(CAMERA,)),
            on_saved=self.count_saved,
        )

    def hear_of_death(self, error: BaseException) -> None:
        self.died.append(error)
        self.died_event.set()

    def count_saved(self) -> None:
        self.saved += 1

    def until(self, seen: Callable[[WizardView], bool]) -> WizardView:
        """The first view that shows it."""
        view = self.wizard.view()
        for _ in range(400):
            if seen(view):
                return view
            view = self.wizard.newer(view.serial, WAIT_S)
        raise AssertionError(f"not seen; last: {view}")

    def after(self, verb: str, **args: Json) -> WizardView:
        """The view after a command and a tick more."""
        self.wizard.send(verb, args)
        self.wizard.send("mark")  # refused by every step
        return self.until(lambda view: view.refused is not None and "mark" in view.refused.what)


@pytest.fixture
def run(tmp_path: Path) -> Iterator[Run]:
    run = Run(tmp_path)
    run.wizard.start()
    yield run
    assert run.wizard.stop(WAIT_S)
    assert not run.died


def happened(view: WizardView) -> object:
    return view.view.details["happened"]


def test_next_goes_on_only_from_a_step_that_is_done(run: Run) -> None:
    run.wizard.send("next")
    refused = run.until(lambda view: view.refused is not None)
    assert refused.step is StepName.CAMERAS
    assert refused.refused is not None
    assert "not done yet" in refused.refused.what
    run.wizard.send("done")
    assert StepName.CAMERAS in run.until(lambda view: bool(view.done)).done
    run.wizard.send("go", {"step": "check"})
    assert run.until(lambda view: view.step is StepName.CHECK).refused is None


def test_a_step_that_cannot_be_begun_leaves_the_one_before_shown(run: Run) -> None:
    run.wizard.send("go", {"step": "room"})
    view = run.until(lambda view: view.refused is not None)
    assert view.step is StepName.CAMERAS
    assert view.refused is not None
    assert view.refused.fix == "do the step Lens first"
    run.wizard.send("done")
    assert run.until(lambda view: view.view.state is StepState.DONE).refused is None


@pytest.mark.parametrize("step", ["colour", "", None, 7])
def test_a_step_that_is_not_there_is_refused(run: Run, step: Json) -> None:
    run.wizard.send("go", {"step": step})
    view = run.until(lambda view: view.refused is not None)
    assert view.refused is not None
    assert "no step" in view.refused.what


def test_begun_again_a_step_knows_nothing_of_before(run: Run) -> None:
    run.wizard.send("done")
    run.until(lambda view: view.view.state is StepState.DONE)
    run.wizard.send("again")
    again = run.until(lambda view: view.view.state is StepState.WAITING)
    assert again.step is StepName.CAMERAS
    assert StepName.CAMERAS in again.done  # its result is still in the draft


def test_a_jobs_result_and_its_failure_reach_the_step(run: Run) -> None:
    def fails(tell: Tell) -> int:
        raise ConfigError("nothing found", "here", "look elsewhere")

    run.wizard.send("job", {"job": lambda tell: 7})
    assert happened(run.until(lambda view: happened(view) != [])) == ["got 7"]
    run.wizard.send("job", {"job": fails})
    run.until(lambda view: happened(view) == ["got 7", "failed: nothing found"])


@pytest.mark.parametrize(
    "error", [np.linalg.LinAlgError("singular"), cv2.error("(-215) too few points")], ids=str
)
def test_where_solvers_end_on_what_was_drawn_is_told_and_not_deadly(
    run: Run, error: Exception
) -> None:
    def fails(tell: Tell) -> int:
        raise error

    run.wizard.send("job", {"job": fails})
    seen = happened(run.until(lambda view: happened(view) != []))
    assert isinstance(seen, list)
    assert "failed: this cannot be worked out" in seen[0]
    for verb in ("raise", "raise_in_tick"):
        run.wizard.send("done")
        run.until(lambda view: view.refused is None)
        run.wizard.send(verb, {"error": error})
        view = run.until(lambda view: view.refused is not None)
        assert view.refused is not None
        assert "cannot be worked out" in view.refused.what


@pytest.mark.parametrize("error", [TypeError("a list"), OverflowError("1e400"), KeyError("cam7")])
def test_a_command_that_meets_a_bug_is_refused_and_the_bug_is_logged(
    run: Run, error: Exception, caplog: pytest.LogCaptureFixture
) -> None:
    run.wizard.send("raise", {"error": error})
    view = run.until(lambda view: view.refused is not None)
    assert view.refused is not None
    assert type(error).__name__ in view.refused.what
    assert "a bug in mocapd: the command 'raise'" in caplog.text
    assert "Traceback" in caplog.text
    run.wizard.send("done")
    assert run.until(lambda view: view.view.state is StepState.DONE).refused is None


def test_commands_beyond_those_that_wait_are_refused(tmp_path: Path) -> None:
    run = Run(tmp_path)
    for _ in range(1000):
        run.wizard.send("done")
    run.wizard.start()
    view = run.until(lambda view: view.refused is not None)
    assert view.refused is not None
    assert "too many commands" in view.refused.what
    run.wizard.send("done")
    run.until(lambda view: view.refused is None)
    assert run.wizard.stop(WAIT_S)


def test_a_job_left_behind_does_not_disturb_the_next_one(run: Run) -> None:
    go_on, told, other = threading.Event(), threading.Event(), threading.Event()

    def left_behind(tell: Tell) -> str:
        tell("the old job", 0.1)
        go_on.wait(WAIT_S)
        tell("the old job still", 0.9)
        told.set()
        return "old"

    def next_one(tell: Tell) -> str:
        tell("the new job", 0.5)
        told.wait(WAIT_S)
        other.wait(WAIT_S)
        return "new"

    run.wizard.send("job", {"job": left_behind})
    run.until(lambda view: view.view.sentence == "the old job")
    run.wizard.send("go", {"step": "check"})
    run.until(lambda view: view.step is StepName.CHECK)
    run.wizard.send("job", {"job": next_one})
    run.until(lambda view: view.view.sentence == "the new job")
    go_on.set()
    assert told.wait(WAIT_S)
    for _ in range(3):
        view = run.wizard.newer(run.wizard.view().serial, WAIT_S)
        assert view.view.sentence == "the new job"
    other.set()
    assert happened(run.until(lambda view: happened(view) != [])) == ["got new"]


def test_done_is_what_is_in_the_draft(tmp_path: Path) -> None:
    run = Run(tmp_path, Draft(cameras=(CAMERA,), rig=Rig((PLACED,))))
    first = run.wizard.view()
    assert first.done == {
        StepName.CAMERAS,
        StepName.ROOM,
    }  # of an earlier setup, done again in part
    run.wizard.start()
    run.wizard.send("save")
    assert StepName.CHECK in run.until(lambda view: view.saved).done
    assert run.saved == 1
    run.wizard.draft = replace(run.wizard.draft, cameras=(CAMERA, replace(CAMERA, id="cam1")))
    run.until(lambda view: StepName.ROOM not in view.done)  # cam1 has no place yet
    assert run.wizard.stop(WAIT_S)


def test_pictures_are_those_of_the_newest_view(run: Run) -> None:
    assert run.wizard.picture("cameras/1") == b"png"
    assert run.wizard.picture("check/1") is None
    run.wizard.send("go", {"step": "check"})
    run.until(lambda view: view.step is StepName.CHECK)
    assert run.wizard.picture("check/1") == b"png"


def test_the_end_is_told(tmp_path: Path) -> None:
    run = Run(tmp_path)
    run.wizard.start()
    assert run.wizard.stop(WAIT_S)
    assert run.wizard.view().ended


def test_a_job_may_begin_while_the_setup_ends(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    ticks, is_ending = threading.Event(), threading.Event()

    def tick(step: ScriptedStep, now_ns: int) -> None:
        ticks.set()
        assert is_ending.wait(WAIT_S)
        if step.context.job is None:
            step.context.start_job(lambda tell: None, lambda result: None)

    monkeypatch.setattr(ScriptedStep, "tick", tick)
    assert ticks.wait(WAIT_S)
    assert not run.wizard.stop(0.0)
    is_ending.set()  # the fixture sees that nothing died


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_an_unexpected_end_is_heard_of(tmp_path: Path) -> None:
    def breaks(tell: Tell) -> None:
        raise ZeroDivisionError("a bug")

    run = Run(tmp_path)
    run.wizard.start()
    run.wizard.send("job", {"job": breaks})
    assert run.died_event.wait(WAIT_S)
    assert [type(error) for error in run.died] == [ZeroDivisionError]
    assert run.wizard.stop(WAIT_S)
