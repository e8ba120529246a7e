"""Commands of the step Colours, with their arguments and ranges."""

from typing import Annotated

import msgspec

from mocapd.wizard.commands import Command, OfCamera, Verbs

LONGEST_COUNTDOWN_S = 30.0
LARGEST_PNG = 8 << 20  # characters of base64


class Freeze(Command, frozen=True):
    """Take the pictures after so many seconds; None: the usual 3."""

    refused = "cannot wait so long"
    fix = f"give 0 to {LONGEST_COUNTDOWN_S:g} seconds"
    seconds: Annotated[float, msgspec.Meta(ge=0.0, le=LONGEST_COUNTDOWN_S)] | None = None


class Propose(Command, frozen=True):
    """Propose strokes again on the present pictures."""


class Strokes(OfCamera, frozen=True):
    """The camera's present strokes: colour ids as an 8-bit grey PNG of the picture's size. by: the page that drew them,
    so that it recognises its own strokes."""

    refused = "the strokes did not come as a picture"
    fix = "reload the page and draw again"
    png_base64: Annotated[str, msgspec.Meta(max_length=LARGEST_PNG)]
    by: Annotated[str, msgspec.Meta(pattern=r"^[\w.\-]{0,80}$")] = ""


class Personal(Command, frozen=True):
    """Whether to use the colours of the wearer's own shirt instead of the standard's."""

    on: bool = False


COLOUR: Verbs = {
    "freeze": Freeze,
    "propose": Propose,
    "strokes": Strokes,
    "personal": Personal,
}
