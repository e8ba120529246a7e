"""A setup in progress as a file of the state directory, from which another process can go on.

`setup-draft.msgpack`: SHA-256 (32 bytes) of what follows, then msgpack of `_Kept`; pictures in it are
PNG. Only its user may read it, as pictures show the wearer; passwords of cameras are not in it.
"""

import hashlib
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Annotated, Literal

import msgspec

from mocapd.boundary.files import read_file
from mocapd.boundary.messages import decode_msgpack
from mocapd.boundary.numbers import brief
from mocapd.errors import CannotCreateError, MalformedError, NewerFileError
from mocapd.whole_file import whole_file
from mocapd.wizard.draft import Draft
from mocapd.wizard.kept_draft import KeptDraft, Table, check_kept, draft_of, kept_draft
from mocapd.wizard.step_names import StepName

FILE_NAME = "setup-draft.msgpack"
SCHEMA = 1
MOST_BYTES = 256 << 20

_DIGEST = hashlib.sha256


class _Schema(msgspec.Struct, frozen=True):
    """What every version has."""

    schema: int


class _Kept(Table, frozen=True):
    schema: Literal[1]
    when: Annotated[datetime, msgspec.Meta(tz=True)]
    done: frozenset[StepName]
    draft: KeptDraft


@dataclass(frozen=True, slots=True, eq=False)
class KeptSetup:
    """when: it was written (UTC); done: steps whose result is in the draft. The cameras' sources are
    without passwords."""

    when: datetime
    done: frozenset[StepName]
    draft: Draft


def write_kept(path: Path, kept: KeptSetup) -> None:
    """Write it whole, for its user alone. Raises CannotCreateError."""
    table = _Kept(schema=1, when=kept.when, done=kept.done, draft=kept_draft(kept.draft))
    body = msgspec.msgpack.encode(table)
    data = _DIGEST(body).digest() + body
    if len(data) > MOST_BYTES:
        raise CannotCreateError(
            f"would have {len(data) >> 20} MB, at most {MOST_BYTES >> 20} are kept", str(path)
        )
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        with whole_file(path, private=True) as partial:
            partial.write_bytes(data)
    except OSError as error:
        raise CannotCreateError(
            f"cannot be written ({error.strerror})", str(path), "make room or the folder writable"
        ) from None


def read_kept(path: Path) -> KeptSetup:
    """Raises MissingError without a file, InputError, MalformedError or ConfigError for a damaged one, NewerFileError."""
    data = read_file(path, MOST_BYTES)
    length = _DIGEST().digest_size
    if _DIGEST(data[length:]).digest() != data[:length]:
        raise MalformedError("its checksum does not fit")
    schema = decode_msgpack(data[length:], _Schema).schema
    if schema > SCHEMA:
        raise NewerFileError(
            f"has schema {brief(schema)}, this mocapd reads {SCHEMA}",
            str(path),
            "go on with the mocapd that wrote it",
        )
    kept = decode_msgpack(data[length:], _Kept)
    check_kept(kept.draft)
    return KeptSetup(kept.when, kept.done, draft_of(kept.draft, str(path)))
