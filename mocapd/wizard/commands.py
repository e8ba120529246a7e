"""Commands of the page: their format, and those of the setup as a whole.

The only entry: `read_command` converts and checks the input, so that a step gets valid commands only. The step itself
checks what depends on its state (existing cameras, running jobs). An argument with a default may be left out, or be null
where None is the default; unknown arguments are ignored.
"""

from collections.abc import Mapping
from typing import ClassVar

import msgspec

from mocapd.boundary.numbers import brief
from mocapd.boundary.parsing import convert
from mocapd.errors import InputError, MalformedError


class Command(msgspec.Struct, frozen=True, kw_only=True):
    """refused, fix: the user's message for wrong arguments."""

    refused: ClassVar[str] = "the page said what is not understood"
    fix: ClassVar[str] = "reload the page"


Verbs = Mapping[str, type[Command]]


def read_command(verbs: Verbs, verb: str, args: Mapping[str, object], where: str) -> Command:
    """The command. Raises InputError for an unknown verb, and for wrong arguments."""
    kind = verbs.get(verb)
    if kind is None:
        raise InputError(f"no command {brief(verb)} in this step", where, "reload the page")
    try:
        command: Command = convert(args, kind)
    except MalformedError as error:
        what, _, at = str(error).partition(" - at ")
        named = at.strip("`").removeprefix("$").removeprefix(".") or verb
        why = f"{named}: {what[:1].lower()}{what[1:]}"
        raise InputError(f"{kind.refused} ({why})", where, kind.fix) from None
    return command


class OfCamera(Command, frozen=True):
    """Of one camera, by its id."""

    camera: str


# -- of the setup as a whole ---------------------------------------------------------------------


class Go(Command, frozen=True):
    """Show this step."""

    refused = "there is no step of this name"
    step: str


class Next(Command, frozen=True):
    """Show the step after this finished one."""


class Again(Command, frozen=True):
    """Begin this step again."""


class Resume(Command, frozen=True):
    """Go on with the unfinished setup of an earlier process."""


class BeginAnew(Command, frozen=True):
    """Discard the unfinished setup."""


class Wear(Command, frozen=True):
    """Whether there is a shirt; without one, its steps are omitted."""

    refused = "whether there is a shirt was not said"
    shirt: bool


OF_WIZARD: Verbs = {
    "go": Go,
    "next": Next,
    "again": Again,
    "resume": Resume,
    "begin_anew": BeginAnew,
    "wear": Wear,
}
