"""A setup in progress as a file, for continuing in another process: a partial `calibration.toml` in a folder of its own.

Only its user may read it, as pictures show the wearer; it has no passwords of cameras.
"""

from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from mocapd.calibration.calibration_file import read_setup
from mocapd.calibration.calibration_writing import write_setup
from mocapd.errors import MalformedError
from mocapd.wizard.draft import Draft
from mocapd.wizard.saving import draft_of, setup_of
from mocapd.wizard.step_names import StepName

FILE_NAME = "setup/calibration.toml"  # in the state directory
OF_EARLIER_VERSIONS = "setup-draft.msgpack"


@dataclass(frozen=True, slots=True, eq=False)
class UnfinishedSetup:
    """when: time of writing (UTC); done: steps with their result in the draft. The cameras' sources lack
    passwords."""

    when: datetime
    done: frozenset[StepName]
    draft: Draft


def write_draft(path: Path, unfinished: UnfinishedSetup) -> None:
    """Write it atomically, readable by its user alone. Raises CannotCreateError."""
    write_setup(path, *setup_of(unfinished.draft, unfinished.when, unfinished.done))


def read_draft(path: Path) -> UnfinishedSetup:
    """Raises MissingError without a file, InputError, MalformedError or ConfigError for a damaged one, NewerFileError."""
    saved = read_setup(path)
    if saved.setup is None:
        raise MalformedError("is of a setup that was finished")
    try:
        done = frozenset(map(StepName, saved.setup.done))
    except ValueError as error:
        raise MalformedError(f"names a step that does not exist ({error})") from None
    return UnfinishedSetup(saved.made.when, done, draft_of(saved, path))
