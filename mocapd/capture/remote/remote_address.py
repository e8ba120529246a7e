"""The address of a remote camera: `zenoh://HOST:PORT/NODE/CAMERA`, and `zenohs://` over TLS."""

import re
from dataclasses import dataclass, field
from urllib.parse import parse_qsl, unquote, urlsplit

from mocapd.boundary.urls import split_url, without_password
from mocapd.capture.remote.camera_wire import ANY
from mocapd.errors import ConfigError

SCHEMES = {"zenoh": "tcp", "zenohs": "tls"}
PORT = 7447
FORM = "zenoh://HOST:PORT/NODE/CAMERA of a camera node (zenohs:// with TLS)"

_CHUNK = re.compile(r"[\w.\-]{1,64}", re.ASCII)  # what needs no replacement in a key
_LONGEST = 2048  # characters
_FILES = ("ca", "certificate", "private_key")


@dataclass(frozen=True, slots=True)
class RemoteAddress:
    """endpoint: of the node or of a router between, as Zenoh writes it; node, camera: names as in the keys; ca: PEM
    file of the authority that signed the other side; certificate, private_key: PEM files of this side."""

    endpoint: str
    node: str
    camera: str
    user: str = ""
    password: str = field(default="", repr=False)
    ca: str = ""
    certificate: str = ""
    private_key: str = ""

    @property
    def place(self) -> str:
        """Node and camera, for people."""
        return f"{self.node}/{self.camera}"


def is_remote(address: str) -> bool:
    """True for an address of this form."""
    return address.partition("://")[0].lower() in SCHEMES and "://" in address


def parse_remote(address: str) -> RemoteAddress:
    """Parses a camera's address. Raises ConfigError, without the password in its message."""
    return _parse_address(address, 2)


def parse_place(address: str) -> RemoteAddress:
    """Parses `zenoh://HOST` or `zenoh://HOST/NODE`; missing names match any. Raises ConfigError."""
    return _parse_address(address, 0)


def address_of(place: str, node: str, camera: str) -> str:
    """The address of a camera at `place`, a URL of host or node."""
    parts = urlsplit(place)
    return parts._replace(path=f"/{node}/{camera}").geturl()


def _parse_address(address: str, fewest: int) -> RemoteAddress:
    """fewest: least number of names, of node and camera."""
    if len(address) > _LONGEST:
        raise ConfigError(f"an address of {len(address)} characters", "source", f"write {FORM}")
    parts = split_url(address)
    shown = without_password(address)
    names = [unquote(name) for name in parts.path.strip("/").split("/") if parts.path.strip("/")]
    good = fewest <= len(names) <= 2 and all(map(_CHUNK.fullmatch, names))
    if not parts.hostname or not good or parts.scheme not in SCHEMES:
        raise ConfigError("no host, node and camera", shown, f"write {FORM}")
    if parts.username is not None and not parts.password:
        raise ConfigError("a user without a password", shown, "write zenohs://user:password@host")
    host = f"[{parts.hostname}]" if ":" in parts.hostname else parts.hostname
    node, camera = [*names, ANY, ANY][:2]
    files = _files(parts.query, shown)
    return RemoteAddress(
        f"{SCHEMES[parts.scheme]}/{host}:{parts.port or PORT}",
        node,
        camera,
        user=unquote(parts.username or ""),
        password=unquote(parts.password or ""),
        ca=files.get("ca", ""),
        certificate=files.get("certificate", ""),
        private_key=files.get("private_key", ""),
    )


def _files(query: str, shown: str) -> dict[str, str]:
    """The PEM files that the address names. Raises ConfigError."""
    try:
        given = parse_qsl(query, keep_blank_values=True, strict_parsing=bool(query))
    except ValueError:
        raise ConfigError("not understood after the ?", shown, "write ?ca=/path/ca.pem") from None
    files = dict(given)
    for name, path in given:
        if name not in _FILES or not path.startswith("/") or "\0" in path:
            raise ConfigError(
                "not understood after the ?",
                shown,
                f"write whole paths of PEM files, of {', '.join(_FILES)}, such as ?ca=/path/ca.pem",
            )
    if ("certificate" in files) != ("private_key" in files):
        raise ConfigError(
            "a certificate and its private key belong together", shown, "give both, or none"
        )
    return files
