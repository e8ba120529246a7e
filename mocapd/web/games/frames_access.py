"""Access control of the frames' WebSocket: only for pages of the sites that the user has allowed.

It checks two things. The Origin, which no page in a browser can forge, must equal one of `web.allow_origins`: this
excludes other sites. The key, which `mocapd web-link` prints and the user gives to the page, excludes other users of
this machine, whose programs can forge an Origin. The key opens this WebSocket only; the page's own token does not open
it.

The key is stored, so that it stays valid after a restart of mocapd.
"""

from dataclasses import dataclass
from pathlib import Path

from starlette.requests import HTTPConnection

from mocapd.web.refusal import Refusal
from mocapd.web.stored_key import key_of, same_secret

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
        """The reason for a refusal; None: access granted. The caller checks the Host."""
        origins = connection.headers.getlist("origin")
        if len(origins) != 1 or origins[0] not in self.origins:
            return Refusal(403, "This site is not in web.allow_origins.")
        if not self.key or not same_secret(connection.query_params.get(KEY, ""), self.key):
            return Refusal(401, "The key is not valid: `mocapd web-link` prints it.")
        return None

    def links(self, host: str) -> tuple[str, ...]:
        """The address to open for each allowed site. host: of the page, with its port."""
        address = f"ws://{host}{PATH}?{KEY}={self.key}"
        return tuple(f"{origin}/#{FRAGMENT}={address}" for origin in self.origins)


def frames_access(origins: tuple[str, ...], state_dir: Path | None) -> FramesAccess:
    """Access for these sites with the key stored in `state_dir`; None: a temporary key.

    Raises InputError for a file without a valid key, CannotCreateError.
    """
    if not origins:
        return FramesAccess()
    return FramesAccess(origins, key_of(state_dir, FILE_NAME))
