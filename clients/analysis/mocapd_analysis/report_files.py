"""The files of a report: none replaces what is not an earlier one of its kind."""

import re
from collections.abc import Sequence
from pathlib import Path

from mocapd.output_file import FileKind, OutputFile, kind_by_magic

REPORT_HTML = FileKind(
    "a report of mocapd-analysis",
    lambda head: head.startswith(b"<!doctype html>") and b": motion</title>" in head,
)
MEASURES_CSV = kind_by_magic("a table of measures", b"session,measure,")
FRAMES_CSV = FileKind(
    "a table of frames", lambda head: re.match(rb"time_s,\w+_x_m,", head) is not None
)


def write_all(
    texts: Sequence[tuple[Path, FileKind, str]], inputs: Sequence[Path], force: bool
) -> None:
    """Write each text to its path, or none of them where one may not be replaced. Raises CannotCreateError."""
    targets = [(OutputFile(path, kind, force, inputs), text) for path, kind, text in texts]
    for target, _ in targets:
        target.check_replaceable()
    for target, text in targets:
        with target.writing() as partial:
            partial.write_text(text, encoding="utf-8")
