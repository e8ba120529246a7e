"""A setup in progress as a file, from which another process can go on: a partial `calibration.toml` of its own folder.

Only its user may read it, as pictures show the wearer; passwords of cameras are not in it.
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
class KeptSetup:
    """when: it was written (UTC); done: steps whose result is in the draft. The cameras' sources are
    without passwords."""

    when: datetime
    done: frozenset[StepName]
    draft: Draft


def write_draft(path: Path, kept: KeptSetup) -> None:
    """Write it whole, for its user alone. Raises CannotCreateError."""
    write_setup(path, *setup_of(kept.draft, kept.when, kept.done))


def read_draft(path: Path) -> KeptSetup:
    """Raises MissingError without a file, InputError, MalformedError or ConfigError for a damaged one, NewerFileError."""
    saved = read_setup(path)
    if saved.setup is None:
        raise MalformedError("is of a setup that was finished")
    try:
        done = frozenset(map(StepName, saved.setup.done))
    except ValueError as error:
        raise MalformedError(f"names a step that does not exist ({error})") from None
    return KeptSetup(saved.made.when, done, draft_of(saved, path))
