"""`python -m tests.capture_checks CAPTURES [WORD]`: captures made wrong on purpose, and what is said of each before tracking.

Then the captures as they are, of which nothing may be said. WORD: only cases whose name or capture has it.
"""

import logging
import sys
import tempfile
from pathlib import Path

from mocapd.capture.kinds.source_kinds import open_origin
from mocapd.errors import MocapdError
from mocapd.session.capture_checks import check_capture
from tests.capture_checks.cases import CASES, WrongCapture, make_wrong


class _Told(logging.Handler):
    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.words: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.words.append(record.getMessage())


def said_of(path: Path) -> tuple[str, tuple[str, ...], list[str]]:
    """Of a capture that somebody would track: whether it is refused, mended, warned of or silent; reasons; and words."""
    told = _Told()
    logging.getLogger("mocapd").addHandler(told)
    try:
        origin = open_origin(str(path), path, lambda *_: None)
        reasons = ["rate"] if any("the stamps are used" in one for one in told.words) else []
        findings = check_capture(origin).result.findings
        reasons += [str(one.mistake) for one in findings]
        outcome = "mended" if all(one.is_mended for one in findings) else "warned"
        return outcome if reasons else "SILENT", tuple(reasons), told.words
    except MocapdError as error:
        return "refused", ("refused",), [str(error)]
    finally:
        logging.getLogger("mocapd").removeHandler(told)


def _row(case: WrongCapture, captures: Path, folder: Path) -> tuple[bool, bool]:
    outcome, reasons, words = said_of(make_wrong(case, captures, folder))
    is_right = bool(set(reasons) & set(case.wanted))
    print(
        f"{outcome:8}| {'right' if is_right else 'other'} | {case.name} | {case.capture} | {', '.join(reasons)}"
    )
    for one in words:
        print(f"    {one.split(': ', 1)[-1]}", flush=True)
    return bool(reasons), is_right


def main() -> int:
    captures, word = Path(sys.argv[1]), sys.argv[2] if len(sys.argv) > 2 else ""
    chosen = [one for one in CASES if word in f"{one.name} {one.capture}"]
    with tempfile.TemporaryDirectory() as folder:
        rows = [_row(one, captures, Path(folder) / str(k)) for k, one in enumerate(chosen)]
    print(
        f"{len(rows)} wrong captures: {sum(1 for told, _ in rows if not told)} silent, "
        f"{sum(1 for _, right in rows if right)} with the right reason",
        flush=True,
    )
    false = 0
    for capture in sorted(captures.iterdir()):
        if word and word not in capture.name:
            continue
        _, reasons, words = said_of(capture)
        false += bool(words)
        print(
            f"as it is | {capture.name} | {', '.join(reasons) or 'nothing'}",
            *words,
            sep="\n    ",
            flush=True,
        )
    print(f"{false} of the captures as they are were warned of")
    return int(any(not told for told, _ in rows) or false > 0)


if __name__ == "__main__":
    sys.exit(main())
