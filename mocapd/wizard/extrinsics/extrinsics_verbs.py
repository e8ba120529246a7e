"""What a person can say in the step Room: each verb with its arguments and their ranges."""

from typing import Literal

from mocapd.wizard.commands import Command, Verbs


class Method(Command, frozen=True):
    """How the room is found; wearer: true does the same as method: "wearer"."""

    refused = "there is no such method"
    fix = "take board or wearer"
    method: Literal["board", "wearer"] = "board"
    wearer: bool = False


class Floor(Command, frozen=True):
    """The board lies on the floor now."""


class SkipFloor(Command, frozen=True):
    """Go on with a guessed one."""


class Solve(Command, frozen=True):
    """With the observations there are."""


class StartWalk(Command, frozen=True):
    """The wearer walks about."""


class StopWalk(Command, frozen=True):
    """End early; nothing is changed."""


ROOM: Verbs = {"method": Method}
BOARD_ROOM: Verbs = {"floor": Floor, "skip_floor": SkipFloor, "solve": Solve}
WEARER_ROOM: Verbs = {"walk": StartWalk, "stop": StopWalk}
