"""Parses user-written addresses, and hides their secrets."""

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
        # the parser's message may repeat the password
        why = "" if has_password(text) else f": {error}"
        raise ConfigError(
            f"{without_password(text)!r} is no address{why}",
            fix="write it as rtsp://user:password@host:port/path, with %2F for a / in the password",
        ) from None
    return parts


def without_password(text: str) -> str:
    """An address without secrets, for display, logs and messages; any other text unchanged.

    A password extends to the last `@`, as users write `/`, `#` and `?` in it unescaped. Also hides query parameters with
    the names of secrets, which many network cameras use.
    """
    match = _CREDENTIALS.match(text)
    if match and _SECRET_QUERY.search(match[2]):
        return f"{match[1]}{HIDDEN}"  # the `@` may be of either secret
    if match:
        user, colon, _ = match[2].partition(":")
        shown = f"{user}:{HIDDEN}" if colon else user
        text = f"{match[1]}{shown}@{text[match.end() :]}"
    return _SECRET_QUERY.sub(rf"\g<1>{HIDDEN}", text) if "://" in text else text


def is_masked(text: str) -> bool:
    """True if the password is masked, so that the address is unusable."""
    return any(f"{before}{HIDDEN}" in text for before in ("://", ":", "=")) and "://" in text


def without_passwords(text: str) -> str:
    """Hides the secrets of all addresses in a text, such as an error message.

    A text that begins with an address counts as one address, as a password may have spaces.
    """
    if _ADDRESS.match(text):
        return without_password(text)
    return _ADDRESS.sub(lambda match: without_password(match[0]), text)


def has_password(text: str) -> bool:
    """True if the text holds a secret."""
    return without_password(text) != text
