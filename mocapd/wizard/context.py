"""The interface of a step of the wizard, and of its context."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Protocol

from mocapd.capture.camera_thread.capture_status import CaptureStatus
from mocapd.errors import MocapdError
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.wizard.commands import Command, Verbs
from mocapd.wizard.draft import Draft
from mocapd.wizard.step import Scene, StepView, T, Tell
from mocapd.wizard.step_names import StepName


class Context(Protocol):
    """The interface of the wizard for its steps. Calls come from the wizard's thread."""

    hub: FrameHub
    draft: Draft  # a step replaces it by a new one after a result
    state_dir: Path
    cache_dir: Path

    def statuses(self) -> Mapping[str, CaptureStatus]:
        """The status of each camera, by id."""

    def scene(self, scene: Scene) -> None:
        """Instruct a simulated person; no effect on real cameras."""

    def start_job(self, job: Callable[[Tell], T], done: Callable[[T], None]) -> None:
        """Run a long job in the worker thread; `done` gets its result in the wizard's thread.

        A MocapdError of the job goes to the step's `job_failed`. One job at a time: a second raises AssertionError.
        After leaving the step the job's result is dropped: `done` is not called.
        """

    def on_saved(self) -> None:
        """Called after writing the draft to the state directory."""

    @property
    def job(self) -> tuple[str, float] | None:
        """The latest progress report of the running job; None without one."""


class Step(Protocol):
    """One step. A new instance for each visit; calls come from one thread at a time.

    A command that does not fit raises a MocapdError, whose text is shown; the step is unchanged.
    """

    name: StepName

    @property
    def verbs(self) -> Verbs:
        """The present commands."""

    def enter(self) -> None:
        """Called when the step is shown."""

    def tick(self, now_ns: int) -> None:
        """About 20 times a second: look at the hub's newest frames, start jobs, change state."""

    def command(self, command: Command) -> None:
        """A command of the user: one of `verbs`."""

    def job_failed(self, error: MocapdError) -> None:
        """Called when the job raised this error."""

    def view(self) -> StepView:
        """The view to show; called after every tick and command, so it must be quick."""

    def leave(self) -> None:
        """Called before another step, or the wizard's end: undo temporary changes."""


class StepAround:
    """Passes on to another step what it does not answer itself; a base for a Step."""

    def __init__(self, inner: Step) -> None:
        self.inner, self.name = inner, inner.name

    def enter(self) -> None:
        self.inner.enter()

    def tick(self, now_ns: int) -> None:
        self.inner.tick(now_ns)

    def job_failed(self, error: MocapdError) -> None:
        self.inner.job_failed(error)

    def leave(self) -> None:
        self.inner.leave()
