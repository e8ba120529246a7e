"""Numbers from outside, as a page or a file says them: finite, in range, and no `true`."""

from mocapd.errors import MalformedError

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


def brief(value: object) -> str:
    """A value from outside as an error may show it: never long, and never itself an error."""
    if isinstance(value, int) and abs(value) >= 10**_MOST_DIGITS:
        return "a number of too many digits"  # repr refuses more than 4,300
    if isinstance(value, str | int | float | bool | None):
        return repr(value[:80] if isinstance(value, str) else value)
    return f"a {type(value).__name__}"
