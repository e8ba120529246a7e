"""Who may have the frames' WebSocket: pages of the sites that the user has allowed, and nobody else.

Two things are asked of them. The Origin, which a browser sends and no page can forge, is one of
`web.allow_origins`, character by character: so no other site gets anything. The key, which
`mocapd web-link` prints and the user gives to the page: so other users of this machine, whose programs
can forge an Origin, get nothing either. The key opens this WebSocket and nothing else; the page's own
token does not open it.

The key is kept, so that a page that has it goes on when mocapd starts anew.
"""

import re
import secrets
from dataclasses import dataclass
from pathlib import Path

from starlette.requests import HTTPConnection

from mocapd.boundary.files import MissingError, read_text
from mocapd.errors import CannotCreateError, InputError
from mocapd.web.refusal import Refusal
from mocapd.whole_file import whole_file

PATH = "/frames"
KEY = "key"  # its name in the URL's query
FILE_NAME = "frames.key"  # in the state directory
FRAGMENT = "mocapd"  # its name after the # in a page's address, which no browser sends to the site
_KEY = re.compile(r"[A-Za-z0-9_-]{32}")
_LONGEST_FILE = 1 << 10  # [bytes]


@dataclass(frozen=True, slots=True)
class FramesAccess:
    """origins: as browsers send them."""

    origins: tuple[str, ...] = ()
    key: str = ""

    def refusal(self, connection: HTTPConnection) -> Refusal | None:
        """Why this one may not have the frames; None: it may. Its Host is looked at before."""
        origins = connection.headers.getlist("origin")
        if len(origins) != 1 or origins[0] not in self.origins:
            return Refusal(403, "This site is not in web.allow_origins.")
        given = connection.query_params.get(KEY, "")
        if not self.key or not secrets.compare_digest(
            given.encode(errors="replace"), self.key.encode()
        ):
            return Refusal(401, "The key is not valid: `mocapd web-link` prints it.")
        return None

    def links(self, host: str) -> tuple[str, ...]:
        """What the user opens, of each allowed site. host: of the page, with its port."""
        address = f"ws://{host}{PATH}?{KEY}={self.key}"
        return tuple(f"{origin}/#{FRAGMENT}={address}" for origin in self.origins)


def frames_access(origins: tuple[str, ...], state_dir: Path | None) -> FramesAccess:
    """For these sites, with the key that is kept in `state_dir`; None: a new one, kept nowhere.

    Raises InputError for a file that holds no key, CannotCreateError.
    """
    if not origins:
        return FramesAccess()
    return FramesAccess(origins, _new_key() if state_dir is None else _kept_key(state_dir))


def _kept_key(state_dir: Path) -> str:
    path = state_dir / FILE_NAME
    try:
        key = read_text(path, _LONGEST_FILE).strip()
    except MissingError:
        return _made(path)
    if not _KEY.fullmatch(key):
        raise InputError("holds no key", str(path), "remove it: the next start makes another")
    return key


def _made(path: Path) -> str:
    key = _new_key()
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        with whole_file(path, private=True) as partial:
            partial.write_text(f"{key}\n", encoding="ascii")
    except OSError as error:
        raise CannotCreateError(
            f"cannot be written: {error.strerror}", str(path), "let this user write there"
        ) from error
    return key


def _new_key() -> str:
    return secrets.token_urlsafe(24)
