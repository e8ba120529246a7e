"""The section [web] of the configuration: the page in the browser."""

import re
from dataclasses import dataclass
from typing import Annotated

from msgspec import Meta

from mocapd.errors import ConfigError

_LOOPBACK = ("localhost", "127.0.0.1", "[::1]")
_ORIGIN = re.compile(
    r"(?P<scheme>https?)://(?P<host>[a-z0-9-]+(\.[a-z0-9-]+)*|\[[0-9a-f:]+\])(:(?P<port>[1-9]\d{0,4}))?"
)
_DEFAULT_PORTS = {"http": "80", "https": "443"}  # a browser omits it


@dataclass(frozen=True, slots=True)
class Params:
    """The page with the setup and the live view, on this machine only (127.0.0.1). Raises ConfigError.

    enabled: serve the page
    port: its TCP port; 0: a free one, printed at the start
    allow_origins: sites whose pages may receive frames (and nothing else), with a link from `mocapd web-link`
    metrics: serve figures for Prometheus at /metrics, to clients with the key in metrics.key of state_dir
    """

    enabled: bool = True
    port: Annotated[int, Meta(ge=0, le=65535)] = 0
    allow_origins: tuple[str, ...] = ()
    metrics: bool = False

    def __post_init__(self) -> None:
        for origin in self.allow_origins:
            _check_origin(origin)


def is_of_this_machine(origin: str) -> bool:
    """True if only this machine serves pages of this origin."""
    parts = _ORIGIN.fullmatch(origin)
    return parts is not None and parts["host"] in _LOOPBACK


def _check_origin(origin: str) -> None:
    """Raises ConfigError for an origin that no browser sends, and for sites without encryption."""
    parts = _ORIGIN.fullmatch(origin)
    if parts is None or parts["port"] == _DEFAULT_PORTS[parts["scheme"]]:
        raise _refusal(
            origin,
            "write the origin as a browser does: https://game.example or http://localhost:8000, in small"
            " letters, without a path, a * or the usual port",
        )
    if parts["scheme"] == "http" and parts["host"] not in _LOOPBACK:
        raise _refusal(
            origin,
            f"write https{origin.removeprefix('http')} (whoever is on the way could change a page without"
            " encryption), or an origin of this machine",
        )


def _refusal(origin: str, fix: str) -> ConfigError:
    return ConfigError(f"{origin[:200]!r} does not do", "web.allow_origins", fix)
