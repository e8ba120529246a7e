"""What a person can say on the page: the form of it, and what is of the setup as a whole.

The one way in: `read_command` makes a command of what came, or refuses it, so that what reaches a step
is already right. What only the step knows (which cameras there are, what is being done) it checks
itself. An argument with a default may be left out, or be null where None is the default; others that
a verb does not have are ignored.
"""

from collections.abc import Mapping
from typing import ClassVar

import msgspec

from mocapd.boundary.numbers import brief
from mocapd.boundary.parsing import convert
from mocapd.errors import InputError, MalformedError


class Command(msgspec.Struct, frozen=True, kw_only=True):
    """refused, fix: what a person is told when the arguments are not right."""

    refused: ClassVar[str] = "the page said what is not understood"
    fix: ClassVar[str] = "reload the page"


Verbs = Mapping[str, type[Command]]


def read_command(verbs: Verbs, verb: str, args: Mapping[str, object], where: str) -> Command:
    """What was said. Raises InputError for another verb, and for arguments that it does not take."""
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
    """Show the step after this one, which is done."""


class Again(Command, frozen=True):
    """Begin this step again."""


class Resume(Command, frozen=True):
    """Go on with the setup that was kept when a process ended."""


class BeginAnew(Command, frozen=True):
    """Forget the setup that was kept."""


class Wear(Command, frozen=True):
    """Whether there is a shirt; without one, its steps are left out."""

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
