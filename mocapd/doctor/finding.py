"""One result of the doctor: subject, verdict and fix."""

from dataclasses import dataclass
from enum import StrEnum


class Verdict(StrEnum):
    """warn: it works or may work; bad: it will not work."""

    OK = "ok"
    WARN = "warn"
    BAD = "bad"


@dataclass(frozen=True, slots=True)
class Finding:
    """about: the subject, such as `webcam`; fix: action or command, empty for OK."""

    verdict: Verdict
    about: str
    what: str
    fix: str = ""


def ok(about: str, what: str) -> Finding:
    """A positive finding."""
    return Finding(Verdict.OK, about, what)


def warn(about: str, what: str, fix: str) -> Finding:
    """A warning: it works or may work."""
    return Finding(Verdict.WARN, about, what, fix)


def bad(about: str, what: str, fix: str) -> Finding:
    """A failure: it will not work."""
    return Finding(Verdict.BAD, about, what, fix)
