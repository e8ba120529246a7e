"""Applies the options `--host` and `--port` of a command to an output's section of the configuration."""

import ipaddress
import socket
from dataclasses import fields, replace
from typing import Any

from mocapd.errors import UnavailableError, UsageError


def override_destination(section: Any, host: str | None, port: int | None) -> Any:
    """The section with one destination. For sections with a key `destination` or `destinations` (`address:port`).

    A host or port of None keeps the section's value, or else the default. Raises UsageError for any other section, and
    UnavailableError for a name without an address.
    """
    names = {field.name for field in fields(section)}
    key = next((name for name in ("destination", "destinations") if name in names), None)
    if key is None:
        raise UsageError(
            "this output cannot be sent elsewhere from the command line",
            "--host, --port",
            "use --set and its own keys",
        )
    old_host, _, old_port = _first_address(getattr(section, key), getattr(type(section)(), key))
    host = old_host.strip("[]") if host is None else resolve_host(host)
    address = address_text(host, int(old_port) if port is None else port)
    return replace(section, **{key: address if key == "destination" else (address,)})


def address_text(host: str, port: int) -> str:
    """`127.0.0.1:9000` or `[::1]:9000`."""
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"


def resolve_host(host: str) -> str:
    """The numeric address of a host, by one look-up. Prefers IPv4, because few games listen on ::1.

    Raises UnavailableError.
    """
    try:
        return str(ipaddress.ip_address(host))
    except ValueError:
        pass
    try:
        results = socket.getaddrinfo(host, None, type=socket.SOCK_DGRAM)
    except (OSError, UnicodeError) as error:
        why = error.strerror if isinstance(error, OSError) else "no name of a host"
        raise UnavailableError(
            f"{host[:100]!r} has no address: {why}",
            "--host",
            "check the name and the network, or give its address in numbers",
        ) from None
    _, _, _, _, address = min(results, key=lambda result: result[0] != socket.AF_INET)
    return str(address[0])


def _first_address(*values: str | tuple[str, ...]) -> tuple[str, str, str]:
    """Host, colon and port of the first `address:port` in these values, which may also be `auto` or empty."""
    texts = [text for value in values for text in ((value,) if isinstance(value, str) else value)]
    return next(text for text in texts if ":" in text).rpartition(":")
