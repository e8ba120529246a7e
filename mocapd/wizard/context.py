"""What a step of the wizard is, and what it is given to work with."""

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
    """What steps work with. Everything is called from the wizard's thread."""

    hub: FrameHub
    draft: Draft  # a step replaces it by a new one when it has found something
    state_dir: Path
    cache_dir: Path

    def statuses(self) -> Mapping[str, CaptureStatus]:
        """How each camera fares, by id."""
        ...

    def scene(self, scene: Scene) -> None:
        """Tell a simulated person what to do; nothing happens with real cameras."""
        ...

    def start_job(self, job: Callable[[Tell], T], done: Callable[[T], None]) -> None:
        """Run something long in the worker thread; `done` gets its result in the wizard's thread.

        A MocapdError that the job raises goes to the step's `job_failed`. One job at a time: a second
        is refused by an AssertionError. Leaving the step forgets the job: `done` is not called.
        """
        ...

    def saved(self) -> None:
        """The draft has been written to the state directory."""
        ...

    @property
    def job(self) -> tuple[str, float] | None:
        """What the running job told last; None when none runs."""
        ...


class Step(Protocol):
    """One step. Made anew when it is entered or begun again; nothing of it is called by two threads.

    A command that does not fit raises a MocapdError, whose text is shown; the step goes on as it was.
    """

    name: StepName

    @property
    def verbs(self) -> Verbs:
        """The commands it takes now."""
        ...

    def enter(self) -> None:
        """It is shown now."""
        ...

    def tick(self, now_ns: int) -> None:
        """About 20 times a second: look at the hub's newest frames, start jobs, change state."""
        ...

    def command(self, command: Command) -> None:
        """Something the person did on the page: one of `verbs`."""
        ...

    def job_failed(self, error: MocapdError) -> None:
        """The job ended with this error."""
        ...

    def view(self) -> StepView:
        """What to show now; called after every tick and command, so it must be quick."""
        ...

    def leave(self) -> None:
        """Another step is shown next, or the wizard ends: undo what must not stay."""
        ...
