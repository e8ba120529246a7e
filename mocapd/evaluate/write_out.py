"""Writes a page's text or plot, and creates its folder."""

from pathlib import Path

from mocapd.errors import creation_errors
from mocapd.output_file import PNG, FileKind, OutputFile

PAGE_KIND = FileKind("a page", lambda head: head.startswith(b"# "))


def write_out(path: Path, data: str | bytes, force: bool = False) -> None:
    """Write a page or a PNG. Raises CannotCreateError."""
    kind = PNG if isinstance(data, bytes) else PAGE_KIND
    with creation_errors(path, "choose another folder with --out"):
        path.parent.mkdir(parents=True, exist_ok=True)
    with OutputFile(path, kind, force).writing() as partial:
        partial.write_bytes(data.encode() if isinstance(data, str) else data)
