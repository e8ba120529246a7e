"""Commands of the step Room, with their arguments and ranges."""

from typing import Literal

from mocapd.wizard.commands import Command, Verbs


class Method(Command, frozen=True):
    """The method of the extrinsics."""

    refused = "there is no such method"
    fix = "take board or wearer"
    method: Literal["board", "wearer"] = "board"


class Floor(Command, frozen=True):
    """The board lies on the floor now."""


class SkipFloor(Command, frozen=True):
    """Go on with a guess of the floor."""


class Solve(Command, frozen=True):
    """Solve with the present observations."""


class StartWalk(Command, frozen=True):
    """The wearer walks about."""


class StopWalk(Command, frozen=True):
    """End early; nothing is changed."""


ROOM: Verbs = {"method": Method}
BOARD_ROOM: Verbs = {"floor": Floor, "skip_floor": SkipFloor, "solve": Solve}
WEARER_ROOM: Verbs = {"walk": StartWalk, "stop": StopWalk}
