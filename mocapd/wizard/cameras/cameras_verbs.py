"""Commands of the step Cameras, with their arguments and ranges."""

from typing import Annotated

import msgspec

from mocapd.wizard.commands import OfCamera, Verbs

LONGEST_NAME = 40
Pixels = Annotated[int, msgspec.Meta(ge=16, le=100_000)]


class LeaveOut(OfCamera, frozen=True):
    """Exclude a camera."""


class TakeIn(OfCamera, frozen=True):
    """Include a camera again."""


class Name(OfCamera, frozen=True):
    """The user's name for it; empty: its id."""

    refused = "this name does not do"
    fix = f"take up to {LONGEST_NAME} printable characters"
    name: Annotated[str, msgspec.Meta(max_length=LONGEST_NAME)] = ""


class ChangeMode(OfCamera, frozen=True):
    """Another size (width, height) and rate, of those that its node lists."""

    size_px: tuple[Pixels, Pixels]
    fps_hz: Annotated[float, msgspec.Meta(gt=0.0, le=1000.0)]


class Lock(OfCamera, frozen=True):
    """Let it settle and lock it again."""


class SamePort(OfCamera, frozen=True):
    """Whether the webcam in another port now is the calibrated one."""

    same: bool


CAMERAS: Verbs = {
    "leave_out": LeaveOut,
    "take_in": TakeIn,
    "name": Name,
    "mode": ChangeMode,
    "lock": Lock,
}
PORTS: Verbs = {"same_port": SamePort}
