"""The password file, checked before Zenoh reads it.

Zenoh admits every client when the file has no user, and silently refuses a user whose line is malformed. It splits a
line at its first colon, strips white space from user and password, and skips blank lines. Messages here never show a
line's content.
"""

import unicodedata
from pathlib import Path

from mocapd.errors import ConfigError

WHERE = "zenoh.password_file"
MAX_BYTES = 32_768  # of a few hundred users; a user's name fits a message of the handshake
BYTE_ORDER_MARK = "\ufeff"


def check_password_file(path: Path) -> None:
    """Raises ConfigError unless the file has at least one user and every line is a valid login."""
    lines = _text(path).split("\n")
    users: dict[str, int] = {}
    for number, line in enumerate(lines, 1):
        line = line.removesuffix("\r")
        if not line.strip():
            continue
        user = _user(line, f"line {number} of {path}")
        if user in users:
            raise _refusal(
                f"lines {users[user]} and {number} of {path} are of the same user",
                "keep one of them",
            )
        users[user] = number
    if not users:
        raise _refusal(
            f"{path} names no user, which would let everyone in",
            "write one line user:password for each user, or set no zenoh.password_file",
        )


def first_login(path: Path) -> tuple[str, str]:
    """User and password of the first line of a checked file. Raises ConfigError."""
    first = next((line for line in _text(path).split("\n") if line.strip()), "")
    user, _, password = first.partition(":")
    return user.strip(), password.strip()


def _text(path: Path) -> str:
    try:
        if not path.is_file():
            raise _refusal(f"{path} is no file", "write a file that exists")
        with path.open("rb") as file:
            data = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise _refusal(
            f"{path} cannot be read: {error.strerror}", "let this user read it"
        ) from None
    if len(data) > MAX_BYTES:
        raise _refusal(f"{path} has more than {MAX_BYTES} bytes", "write lines user:password only")
    try:
        text = data.decode()
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        # not chained: the original error holds the whole file
        raise _refusal(f"line {line} of {path} is no UTF-8", "save it as UTF-8") from None
    if text.startswith(BYTE_ORDER_MARK):
        raise _refusal(
            f"{path} begins with a byte order mark, which would belong to the first user's name",
            "save it as UTF-8 without BOM",
        )
    return text


def _user(line: str, where: str) -> str:
    """The user of one line. Raises ConfigError for an invalid login."""
    user, colon, password = (part.strip() for part in line.partition(":"))
    if not colon:
        raise _refusal(f"{where} has no colon", "write user:password")
    if not user or not password:
        raise _refusal(f"{where} has no {'password' if user else 'user'}", "write user:password")
    if any(unicodedata.category(character) == "Cc" for character in line if character != "\t"):
        raise _refusal(f"{where} has a control character", "write user:password without it")
    return user


def _refusal(what: str, fix: str) -> ConfigError:
    return ConfigError(what, WHERE, fix)
