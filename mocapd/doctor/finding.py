"""One line of the doctor's: what was looked at, whether it is well, and what would mend it."""

from dataclasses import dataclass
from enum import StrEnum


class Verdict(StrEnum):
    """warn: it works, or may; bad: it will not."""

    OK = "ok"
    WARN = "warn"
    BAD = "bad"


@dataclass(frozen=True, slots=True)
class Finding:
    """about: a word, such as `webcam`; fix: what to do or to type, empty where all is well."""

    verdict: Verdict
    about: str
    what: str
    fix: str = ""


def ok(about: str, what: str) -> Finding:
    """All is well."""
    return Finding(Verdict.OK, about, what)


def warn(about: str, what: str, fix: str) -> Finding:
    """It works, or may."""
    return Finding(Verdict.WARN, about, what, fix)


def bad(about: str, what: str, fix: str) -> Finding:
    """It will not work."""
    return Finding(Verdict.BAD, about, what, fix)
