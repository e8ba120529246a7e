"""Who may have the frames' WebSocket: pages of the sites that the user has allowed, and nobody else.

Two things are asked of them. The Origin, which a browser sends and no page can forge, is one of
`web.allow_origins`, character by character: so no other site gets anything. The key, which
`mocapd web-link` prints and the user gives to the page: so other users of this machine, whose programs
can forge an Origin, get nothing either. The key opens this WebSocket and nothing else; the page's own
token does not open it.

The key is kept, so that a page that has it goes on when mocapd starts anew.
"""

import secrets
from dataclasses import dataclass
from pathlib import Path

from starlette.requests import HTTPConnection

from mocapd.web.kept_key import kept_key, new_key
from mocapd.web.refusal import Refusal

PATH = "/frames"
KEY = "key"  # its name in the URL's query
FILE_NAME = "frames.key"  # in the state directory
FRAGMENT = "mocapd"  # its name after the # in a page's address, which no browser sends to the site


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
    key = new_key() if state_dir is None else kept_key(state_dir / FILE_NAME)
    return FramesAccess(origins, key)
