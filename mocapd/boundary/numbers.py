"""Validates numbers from pages and files: finite, in range, and no booleans."""

import math
from collections.abc import Iterator

from mocapd.errors import MalformedError

MOST = 2**31 - 1  # of any number in a file of ours, whole or not
_MOST_DIGITS = 18  # of a whole number in text; int() itself takes quadratic time over them


def finite_number(value: object, low: float, high: float) -> float:
    """A number of JSON or TOML from `low` to `high`. Raises MalformedError."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise MalformedError(f"{brief(value)} is no number")
    if not low <= value <= high:  # NaN is in no range; a whole number of 400 digits compares too
        raise MalformedError(f"{brief(value)} is not from {low:g} to {high:g}")
    return float(value)


def whole_number(value: object, low: int, high: int) -> int:
    """A whole number of JSON or TOML from `low` to `high`; 3.0 is one. Raises MalformedError."""
    number = finite_number(value, low, high)
    if number != int(number):
        raise MalformedError(f"{brief(value)} is no whole number")
    return int(number)


def whole_number_of_text(text: str, low: int, high: int) -> int:
    """Decimal digits as a number from `low` to `high`. Raises MalformedError."""
    digits = text.strip()
    if not (digits.isascii() and digits.isdecimal()) or len(digits) > _MOST_DIGITS:
        raise MalformedError(f"{brief(text)} is no whole number")
    return whole_number(int(digits), low, high)


def check_numbers(tree: object) -> None:
    """Checks that every number of a parsed file is finite and between -MOST and MOST, so that sums and products do not
    overflow. Raises MalformedError that names its key."""
    for key, value in _numbers(tree, ""):
        if not -MOST <= value <= MOST:
            finite = isinstance(value, int) or math.isfinite(value)
            raise MalformedError(f"{key!r} is {'far too large' if finite else 'not finite'}")


def _numbers(tree: object, key: str) -> Iterator[tuple[str, float]]:
    """Every number with its key. Parsed trees are nested a few levels deep, see messages."""
    if isinstance(tree, dict):
        for name, item in tree.items():
            yield from _numbers(item, f"{key}.{name}" if key else str(name))
    elif isinstance(tree, list):
        for i, item in enumerate(tree):
            yield from _numbers(item, f"{key}[{i}]")
    elif isinstance(tree, int | float):
        yield key, tree


def brief(value: object) -> str:
    """A short representation of a value for messages; never raises."""
    if isinstance(value, int) and abs(value) >= 10**_MOST_DIGITS:
        return "a number of too many digits"  # repr refuses more than 4,300
    if isinstance(value, str | int | float | bool | None):
        return repr(value[:80] if isinstance(value, str) else value)
    return f"a {type(value).__name__}"
