"""Output files of commands: an existing file is replaced with `--force` only."""

import os
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from pathlib import Path

from mocapd.boundary.files import MissingError, is_absent, is_folder, read_beginning
from mocapd.errors import CannotCreateError, InputError, creation_errors
from mocapd.whole_file import whole_file

_HEAD_BYTES = 4096


@dataclass(frozen=True, slots=True)
class FileKind:
    """A format. name: with its article; begins_so: tests the first bytes of a file."""

    name: str
    begins_so: Callable[[bytes], bool]


def kind_by_magic(name: str, *magic: bytes) -> FileKind:
    """The format of files with one of these magic numbers."""
    return FileKind(name, lambda head: head.startswith(magic))


PDF = kind_by_magic("a PDF", b"%PDF-")
PNG = kind_by_magic("a PNG picture", b"\x89PNG\r\n\x1a\n")


@dataclass(frozen=True, slots=True)
class OutputFile:
    """One output file of a command, and the rules of replacement.

    kind: format of the file; force: replace an existing file, but none of another format in a folder that the command
    reads; inputs: paths that the command reads, never replaced; option: that names the file, empty for an argument. An
    empty file has every format.
    """

    path: Path
    kind: FileKind
    force: bool = False
    inputs: Sequence[Path] = ()
    option: str = "--out"

    def check(self) -> None:
        """Call before a long run: raises CannotCreateError when the file is not writable."""
        self.check_replaceable()
        folder, prefix = self.path.absolute().parent, f".{self.path.name}."
        with self._named_errors():
            descriptor, name = tempfile.mkstemp(dir=folder, prefix=prefix)
        os.close(descriptor)
        Path(name).unlink()

    @contextmanager
    def writing(self) -> Iterator[Path]:
        """Yields a path to write to, which atomically becomes `path` on success. Raises CannotCreateError."""
        self.check_replaceable()
        with self._named_errors(), whole_file(self.path) as partial:
            yield partial
            self.check_replaceable()  # another process may have created it

    def check_replaceable(self) -> None:
        """Raises CannotCreateError for a file that must not be replaced."""
        path = str(self.path)
        elsewhere = self._choose_another("name")
        if is_absent(self.path):
            return
        if any(_are_same(source, self.path) for source in self.inputs):
            raise CannotCreateError("is what the command reads", path, elsewhere)
        in_input = any(_lies_in(source, self.path) for source in self.inputs)
        try:
            head = read_beginning(self.path, _HEAD_BYTES)
        except MissingError:
            return  # removed meanwhile
        except InputError as error:
            there = "is there already, and " if os.path.lexists(path) else ""
            raise CannotCreateError(f"{there}{error.what}", path, elsewhere) from None
        is_kind = not head or self.kind.begins_so(head)
        is_spared = in_input and not is_kind
        if self.force and not is_spared:
            return
        raise CannotCreateError(
            "is there already" + ("" if is_kind else f", and is not {self.kind.name}"),
            path,
            elsewhere if is_spared else f"{elsewhere}, or replace it with --force",
        )

    def _choose_another(self, what: str) -> str:
        return f"choose another {what}" + (f" with {self.option}" if self.option else "")

    def _named_errors(self) -> AbstractContextManager[None]:
        return creation_errors(self.path, self._choose_another("place"))


def _are_same(source: Path, target: Path) -> bool:
    """Also by a link, hard or not."""
    try:
        return source.samefile(target)
    except (OSError, ValueError):
        return False


def _lies_in(folder: Path, target: Path) -> bool:
    return target.resolve().is_relative_to(folder.resolve()) and is_folder(folder)
