"""The daemon's Zenoh session: its parameters, and the Zenoh configuration for them.

Zenoh's own defaults are not safe here: a peer listens on every address, scouts by multicast and
gossips. This session opens one socket on 127.0.0.1 by default. Clients may subscribe and query,
never write.
"""

import ipaddress
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from msgspec import Meta

from mocapd.boundary.files import is_file
from mocapd.bus.zenoh_limits import receive_limits, unicast_limits
from mocapd.errors import ConfigError
from mocapd.outputs.zenoh.zenoh_password_file import check_password_file

LOOPBACK = "127.0.0.1"
PORT = 7447
FORMATS = ("msgpack", "json")
ENCRYPTED = ("tls", "quic")

# stored as text; a relative path starts at the configuration file
PathText = Annotated[str, Meta(extra={"is_path": True})]


@dataclass(frozen=True, slots=True)
class Params:
    """The daemon's Zenoh session. Raises ConfigError with the value and the remedy.

    format: `msgpack` or `json`
    port: TCP port on 127.0.0.1; 7447 is also the usual port of a Zenoh router
    listen: endpoints to listen on instead, such as `tls/0.0.0.0:7447`
    connect: endpoints of a router to connect to, such as `tcp/127.0.0.1:7447`; the daemon then opens no port
    connect_timeout_s: how long to try to reach that router [s]
    allow_unencrypted: permit unencrypted `tcp/` to other machines
    tls_certificate, tls_private_key: PEM files of this daemon, for `tls/` in `listen`, or for a router that requires them
    tls_root_ca: PEM file of the authority that signed the certificate of the other side
    tls_require_client: accept only clients with a certificate of `tls_root_ca`
    password_file: accept only the users in this file, lines `user:password` (use it with `tls/`)
    """

    format: str = "msgpack"
    port: int = PORT
    listen: tuple[str, ...] = ()
    connect: tuple[str, ...] = ()
    connect_timeout_s: float = 3.0
    allow_unencrypted: bool = False
    tls_certificate: PathText = ""
    tls_private_key: PathText = ""
    tls_root_ca: PathText = ""
    tls_require_client: bool = False
    password_file: PathText = ""

    def __post_init__(self) -> None:
        _require(self.format in FORMATS, "format", self.format, f"one of {', '.join(FORMATS)}")
        _require(0 < self.port < 65536, "port", self.port, "a port from 1 to 65535")
        _require(
            self.connect_timeout_s > 0, "connect_timeout_s", self.connect_timeout_s, "more than 0"
        )
        _require(
            not (self.listen and self.connect),
            "connect",
            list(self.connect),
            "either zenoh.listen (be reached) or zenoh.connect (join a router), not both",
        )
        for endpoint in self.connect:
            _protocol_of(endpoint, "connect")
        for endpoint in self.listen:
            self._check_listen(endpoint)
        for name in ("tls_certificate", "tls_private_key", "tls_root_ca", "password_file"):
            path = str(getattr(self, name))
            _require(not path or is_file(Path(path)), name, path, "a file that exists")
        if self.password_file:
            check_password_file(Path(self.password_file))
        _require(
            not self.tls_require_client or bool(self.tls_root_ca),
            "tls_require_client",
            True,
            "zenoh.tls_root_ca as well: the authority of the clients' certificates",
        )

    def _check_listen(self, endpoint: str) -> None:
        protocol = _protocol_of(endpoint, "listen")
        if protocol in ENCRYPTED:
            _require(
                bool(self.tls_certificate and self.tls_private_key),
                "listen",
                endpoint,
                "zenoh.tls_certificate and zenoh.tls_private_key as well",
            )
        elif not is_loopback(endpoint):
            _require(
                self.allow_unencrypted,
                "listen",
                endpoint,
                f"tls{endpoint[len(protocol) :]} (anyone on that network could read the stream), or "
                "zenoh.allow_unencrypted = true",
            )


def _protocol_of(endpoint: str, key: str) -> str:
    """`tcp` of `tcp/127.0.0.1:7447`. Raises ConfigError when the endpoint has no such form."""
    protocol, slash, address = endpoint.partition("/")
    _, colon, port = without_options(address).rpartition(":")
    _require(
        bool(protocol and slash and colon) and port.isdecimal(),
        key,
        endpoint,
        "protocol/address:port, such as tcp/127.0.0.1:7447",
    )
    return protocol


def without_options(endpoint: str) -> str:
    """`tcp/127.0.0.1:7447` of `tcp/127.0.0.1:7447#iface=eth0`."""
    return endpoint.partition("#")[0].partition("?")[0]


def is_loopback(endpoint: str) -> bool:
    """Whether an endpoint such as `tcp/127.0.0.1:7447` stays on this machine."""
    address = without_options(endpoint).partition("/")[2].rpartition(":")[0].strip("[]")
    try:
        return ipaddress.ip_address(address).is_loopback
    except ValueError:
        return False  # a name: it may resolve to any address


def _require(holds: bool, key: str, value: object, wanted: str) -> None:
    if not holds:
        raise ConfigError(f"{value!r} does not do", f"zenoh.{key}", f"write {wanted}")


def listen_endpoints(params: Params) -> tuple[str, ...]:
    """The endpoints that the session listens on; empty when it joins a router."""
    if params.connect:
        return ()
    return params.listen or (f"tcp/{LOOPBACK}:{params.port}",)


def session_config(params: Params) -> dict[str, Any]:
    """Zenoh's configuration (its JSON5 tree) for these parameters."""
    config: dict[str, Any] = {
        "mode": "client" if params.connect else "peer",
        "scouting": {"multicast": {"enabled": False}, "gossip": {"enabled": False}},
        # frames are smaller than what shared memory is used for
        "transport": {
            "shared_memory": {"enabled": False},
            "unicast": unicast_limits(),
            "link": {"tls": _tls(params), "rx": receive_limits()},
            "auth": {"usrpwd": {"dictionary_file": params.password_file or None}},
        },
    }
    if params.connect:
        config["connect"] = {
            "endpoints": list(params.connect),
            "timeout_ms": round(params.connect_timeout_s * 1000),
        }
        return config
    config["listen"] = {"endpoints": list(listen_endpoints(params))}
    config["access_control"] = READ_ONLY
    # lets the status line query the subscribers; READ_ONLY denies it to clients
    config["adminspace"] = {"enabled": True, "permissions": {"read": True, "write": False}}
    return config


def _tls(params: Params) -> dict[str, Any]:
    shows_own = bool(params.connect and params.tls_certificate)
    return {
        "listen_certificate": params.tls_certificate or None,
        "listen_private_key": params.tls_private_key or None,
        "root_ca_certificate": params.tls_root_ca or None,
        "enable_mtls": params.tls_require_client or shows_own,
        "connect_certificate": params.tls_certificate if shows_own else None,
        "connect_private_key": params.tls_private_key if shows_own else None,
    }


READ_ONLY: dict[str, Any] = {
    "enabled": True,
    "default_permission": "deny",
    "rules": [
        {
            "id": "ask",
            "messages": [
                "declare_subscriber",
                "query",
                "liveliness_query",
                "declare_liveliness_subscriber",
            ],
            "flows": ["ingress"],
            "permission": "allow",
            "key_exprs": ["mocapd/**"],
        },
        {
            "id": "publish",
            "messages": ["put", "delete", "reply", "liveliness_token"],
            "flows": ["egress"],
            "permission": "allow",
            "key_exprs": ["mocapd/**"],
        },
    ],
    "subjects": [{"id": "anyone"}],
    "policies": [{"rules": ["ask", "publish"], "subjects": ["anyone"]}],
}
