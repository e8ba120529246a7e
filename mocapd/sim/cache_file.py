"""What the simulator keeps in the cache: one msgpack file each, read only when its key fits."""

from pathlib import Path
from typing import Protocol, TypeVar

import msgspec

from mocapd.errors import CannotCreateError
from mocapd.whole_file import whole_file


class Keyed(Protocol):
    """`key` tells what the file was made from."""

    @property
    def key(self) -> str: ...


F = TypeVar("F", bound=Keyed)


def read_cached(path: Path, key: str, kind: type[F]) -> F | None:
    """What is kept there, or None when there is nothing that fits."""
    try:
        stored = msgspec.msgpack.decode(path.read_bytes(), type=kind)
    except (OSError, msgspec.DecodeError):
        return None
    return stored if stored.key == key else None


def write_cached(path: Path, file: Keyed) -> None:
    """Write it whole or not at all. Raises CannotCreateError."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with whole_file(path) as partial:
            partial.write_bytes(msgspec.msgpack.encode(file))
    except OSError as error:
        raise CannotCreateError(
            f"the simulator's cache cannot be written ({error})",
            str(path),
            "free space there or choose another cache directory",
        ) from None
