"""The view of a step of the wizard, and the matching scene of a simulated person."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TypeVar

from mocapd.errors import Problem

T = TypeVar("T")
# reports the current task and progress 0..1; called in the job's thread
Tell = Callable[[str, float], None]
Json = object  # what `json.dumps` takes


class Scene(StrEnum):
    """Instructions to a simulated person, so that a step has suitable pictures."""

    EMPTY = "empty"  # no person in the room
    LENS = "lens"  # the board is shown to every camera, at many places and slants
    ROOM = "room"  # the board is held where the cameras see it together
    FLOOR = "floor"  # the board lies on the floor
    T_POSE = "t_pose"  # the wearer stands still, arms out
    ARM_BENDS = "arm_bends"  # T-pose, and the elbows bend
    MOVING = "moving"  # walks about and moves the arms


class StepState(StrEnum):
    """`waiting`: for the user; `working`: on a long task; `done`: the user may go on; `failed`: no result, `problems` say
    why, and the user can continue the step or begin it again."""

    WAITING = "waiting"
    WORKING = "working"
    DONE = "done"
    FAILED = "failed"


@dataclass(frozen=True, slots=True)
class Shape:
    """Something to draw over a camera's picture: kind `points`, `line`, `polygon`, `text` or `halo`.

    at_px: x, y pairs in pixels of the camera's whole frame; style: a class of `page/style.css`
    (`good`, `bad`, `hint`, `bone`, `cell-0`..`cell-3`); text: for `text`, at the first point;
    radii_px: for `halo`, soft bands between each two points, how wide on either side of each point.
    """

    kind: str
    at_px: tuple[tuple[float, float], ...]
    style: str = "good"
    text: str = ""
    radii_px: tuple[float, ...] = ()


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
