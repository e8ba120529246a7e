"""A file that a command writes for its user: what is there already is not replaced unless it is of the same kind."""

import os
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from mocapd.boundary.files import MissingError, is_absent, is_folder, read_beginning
from mocapd.errors import CannotCreateError, InputError, mend_of
from mocapd.whole_file import whole_file

_HEAD_BYTES = 4096


@dataclass(frozen=True, slots=True)
class FileKind:
    """A format. name: with its article; begins_so: whether the first bytes of a file are of this format."""

    name: str
    begins_so: Callable[[bytes], bool]


def kind_by_magic(name: str, *magic: bytes) -> FileKind:
    """The kind of files that begin with one of these bytes."""
    return FileKind(name, lambda head: head.startswith(magic))


def kind_by_first_line(name: str, text: str) -> FileKind:
    """The kind of texts that have the first line of this one."""
    line = text.encode().partition(b"\n")[0][: _HEAD_BYTES - 1]
    return FileKind(name, lambda head: head.startswith(line))


PDF = kind_by_magic("a PDF", b"%PDF-")
PNG = kind_by_magic("a PNG picture", b"\x89PNG\r\n\x1a\n")


@dataclass(frozen=True, slots=True)
class OutputFile:
    """Where a command writes one file, and what it may replace there.

    kind: None where even an earlier file of this kind stays, as it cannot be made again; force: replace whatever file
    is there, but none of another kind in a folder that the command reads; inputs: what the command reads, which is never
    replaced. An empty file is of every kind.
    """

    path: Path
    kind: FileKind | None
    force: bool = False
    inputs: Sequence[Path] = ()

    def check(self) -> None:
        """For before a long run: raises CannotCreateError when the file could not be written now."""
        self.check_replaceable()
        folder, prefix = self.path.absolute().parent, f".{self.path.name}."
        try:
            descriptor, name = tempfile.mkstemp(dir=folder, prefix=prefix)
        except OSError as error:
            raise self._cannot(error) from None
        os.close(descriptor)
        Path(name).unlink()

    @contextmanager
    def writing(self) -> Iterator[Path]:
        """Yield a path to write to; that file becomes `path` when all went well. Raises CannotCreateError."""
        self.check_replaceable()
        try:
            with whole_file(self.path) as partial:
                yield partial
                self.check_replaceable()  # somebody else's may have come meanwhile
        except OSError as error:
            raise self._cannot(error) from None

    def check_replaceable(self) -> None:
        """Raises CannotCreateError for what is there and must stay."""
        path = str(self.path)
        elsewhere = "choose another name" + (" with --out" if self.kind is not None else "")
        if is_absent(self.path):
            return
        if any(_are_same(source, self.path) for source in self.inputs):
            raise CannotCreateError("is what the command reads", path, elsewhere)
        in_input = any(_lies_in(source, self.path) for source in self.inputs)
        try:
            head = read_beginning(self.path, _HEAD_BYTES)
        except MissingError:
            return  # it went meanwhile
        except InputError as error:
            raise CannotCreateError(
                f"is there already, and {error.what}", path, elsewhere
            ) from None
        if self.kind is not None and (not head or self.kind.begins_so(head)):
            return
        if self.force and not in_input:
            return
        raise CannotCreateError(
            "is there already" + (f", and is not {self.kind.name}" if self.kind else ""),
            path,
            elsewhere if in_input else f"{elsewhere}, or replace it with --force",
        )

    def _cannot(self, error: OSError) -> CannotCreateError:
        return CannotCreateError(
            f"cannot be written ({error.strerror})",
            str(self.path),
            mend_of(error, "choose another place with --out"),
        )


def _are_same(source: Path, target: Path) -> bool:
    """Also by a link, hard or not."""
    try:
        return source.samefile(target)
    except (OSError, ValueError):
        return False


def _lies_in(folder: Path, target: Path) -> bool:
    return target.resolve().is_relative_to(folder.resolve()) and is_folder(folder)
