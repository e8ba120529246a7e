"""Commands of the step Body, with their arguments and ranges."""

from typing import Annotated

import msgspec

from mocapd.wizard.commands import Command, Verbs

_SHORTEST_M, _TALLEST_M = 0.8, 2.3


class Stature(Command, frozen=True):
    """How tall the wearer is without shoes [m]."""

    refused = "this stature cannot be"
    fix = f"type it in metres, {_SHORTEST_M} to {_TALLEST_M}: 1.75 is 175 cm or 5 ft 9 in"
    m: Annotated[float, msgspec.Meta(ge=_SHORTEST_M, le=_TALLEST_M)]


class MeasureBody(Command, frozen=True):
    """Measure the wearer's proportions, perhaps again."""


class SkipBody(Command, frozen=True):
    """Go on with the mean proportions of this stature."""


BODY: Verbs = {"stature": Stature, "measure": MeasureBody, "skip": SkipBody}
