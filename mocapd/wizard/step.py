"""What a step of the wizard is, what it shows, and what it is given to work with."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import Protocol, TypeVar

from mocapd.capture.thread import CaptureStatus
from mocapd.errors import MocapdError
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.wizard.commands import Command, Verbs
from mocapd.wizard.draft import Draft

T = TypeVar("T")
Tell = Callable[[str, float], None]  # what is being done, share done 0..1; from the job's thread
Json = object  # what `json.dumps` takes


class StepName(StrEnum):
    """The steps in their order."""

    CAMERAS = "cameras"
    LENS = "lens"
    ROOM = "room"
    COLOUR = "colour"
    BODY = "body"
    CHECK = "check"


class Scene(StrEnum):
    """What a simulated person is told to do, so that a step has something to see."""

    EMPTY = "empty"  # nobody in the room
    LENS = "lens"  # the board is shown to every camera, at many places and slants
    ROOM = "room"  # the board is held where the cameras see it together
    FLOOR = "floor"  # the board lies on the floor
    T_POSE = "t_pose"  # the wearer stands still, arms out
    ARM_BENDS = "arm_bends"  # T-pose, and the elbows bend
    MOVING = "moving"  # walks about and moves the arms


class StepState(StrEnum):
    """`waiting`: for the person; `working`: on something long; `done`: one may go on; `failed`:
    nothing was found, `problems` say why, and the step can be continued or begun again."""

    WAITING = "waiting"
    WORKING = "working"
    DONE = "done"
    FAILED = "failed"


@dataclass(frozen=True, slots=True)
class Problem:
    """Trouble told to the person: what, where (a camera, a file; may be empty), and how to mend it."""

    what: str
    where: str = ""
    fix: str = ""

    @classmethod
    def of(cls, error: MocapdError) -> "Problem":
        return cls(error.what, error.where, error.fix)


@dataclass(frozen=True, slots=True)
class Shape:
    """Something to draw over a camera's picture: kind `points`, `line`, `polygon` or `text`.

    at_px: x, y pairs in pixels of the camera's whole frame; style: a class of `page/style.css`
    (`good`, `bad`, `hint`, `bone`, `cell-0`..`cell-3`); text: for `text`, at the first point.
    """

    kind: str
    at_px: tuple[tuple[float, float], ...]
    style: str = "good"
    text: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class StepView:
    """What the page shows of a step.

    sentence: the one thing to do next; progress: 0..1; overlays: by camera id, over the live picture;
    details: what the step's own part of the page needs, JSON; pictures: PNG or JPEG bytes by key,
    fetched by the page when `details` names a key it has not got (keys change when bytes do).
    """

    state: StepState
    sentence: str
    progress: float = 0.0
    problems: tuple[Problem, ...] = ()
    overlays: Mapping[str, tuple[Shape, ...]] = field(default_factory=dict)
    details: Mapping[str, Json] = field(default_factory=dict)
    pictures: Mapping[str, bytes] = field(default_factory=dict)


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
