"""Addresses that somebody wrote: taken apart without surprises, and shown without their secrets."""

import re
from urllib.parse import SplitResult, urlsplit

from mocapd.errors import ConfigError

HIDDEN = "***"

_CREDENTIALS = re.compile(r"^([\x00-\x20]*[a-z][a-z0-9+.\-]*://)(.*)@", re.IGNORECASE | re.DOTALL)
_ADDRESS = re.compile(r"[a-z][a-z0-9+.\-]*://\S+", re.IGNORECASE)
_SECRET_QUERY = re.compile(
    r"([?&;](?:[\w.\-]*(?:pass|pwd|secret|token|key|auth|credential|sig)[\w.\-]*|pw|p)=)[^&;#]*",
    re.IGNORECASE,
)


def split_url(text: str) -> SplitResult:
    """The parts of a URL. Raises ConfigError for one that has no parts, such as `rtsp://[bad`."""
    try:
        parts = urlsplit(text)
        _ = parts.port  # also when it is no number
    except ValueError as error:
        # the parser's own words repeat what it could not read
        why = "" if has_password(text) else f": {error}"
        raise ConfigError(
            f"{without_password(text)!r} is no address{why}",
            fix="write it as rtsp://user:password@host:port/path, with %2F for a / in the password",
        ) from None
    return parts


def without_password(text: str) -> str:
    """An address as it may be shown, logged and sent; any other text as it is.

    A password ends at the last `@`, whatever it holds: people write `/`, `#` and `?` in it unescaped.
    Hidden are also values of the query that are named as secrets, as many network cameras want them.
    """
    found = _CREDENTIALS.match(text)
    if found and _SECRET_QUERY.search(found[2]):
        return f"{found[1]}{HIDDEN}"  # the `@` may be of either secret
    if found:
        user, colon, _ = found[2].partition(":")
        shown = f"{user}:{HIDDEN}" if colon else user
        text = f"{found[1]}{shown}@{text[found.end() :]}"
    return _SECRET_QUERY.sub(rf"\g<1>{HIDDEN}", text) if "://" in text else text


def is_masked(text: str) -> bool:
    """Whether its password is hidden, so that nothing can be reached by it."""
    return any(f"{before}{HIDDEN}" in text for before in ("://", ":", "=")) and "://" in text


def without_passwords(text: str) -> str:
    """A text in which addresses may stand, such as an error's, as it may be shown and sent.

    One that begins with an address is taken for an address as a whole: a password may have spaces.
    """
    if _ADDRESS.match(text):
        return without_password(text)
    return _ADDRESS.sub(lambda found: without_password(found[0]), text)


def has_password(text: str) -> bool:
    """Whether showing it would show a secret."""
    return without_password(text) != text
