"""An output's section, aimed at one address: what `--host` and `--port` of a command mean to it."""

import ipaddress
import socket
from dataclasses import fields, replace
from typing import Any

from mocapd.errors import UnavailableError, UsageError


def aimed_by_destination(section: Any, host: str | None, port: int | None) -> Any:
    """For sections that say where they send in `destination` or `destinations`, as `address:port`: that alone. What is
    not given stays as it is there, or as it is when nothing is configured. Raises UsageError for any other section.
    """
    names = {field.name for field in fields(section)}
    key = next((one for one in ("destination", "destinations") if one in names), None)
    if key is None:
        raise UsageError(
            "this output cannot be sent elsewhere from the command line",
            "--host, --port",
            "use --set and its own keys",
        )
    now_host, _, now_port = _first(getattr(section, key), getattr(type(section)(), key))
    if host is None:
        host = now_host.removeprefix("[").removesuffix("]")
    address = address_text(host, int(now_port) if port is None else port)
    return replace(section, **{key: address if key == "destination" else (address,)})


def address_text(host: str, port: int) -> str:
    """`127.0.0.1:9000` or `[::1]:9000`."""
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"


def resolved(host: str) -> str:
    """The numeric address of a host, looked up once; of several the first that is IPv4, as few games listen on ::1.
    Raises UnavailableError."""
    try:
        return str(ipaddress.ip_address(host))
    except ValueError:
        pass
    try:
        found = socket.getaddrinfo(host, None, type=socket.SOCK_DGRAM)
    except (OSError, UnicodeError) as error:
        why = error.strerror if isinstance(error, OSError) else "no name of a host"
        raise UnavailableError(
            f"no address is known of {host[:100]!r}: {why}",
            "--host",
            "check the name and the network, or give its address in numbers",
        ) from None
    addresses = [str(one[4][0]) for one in sorted(found, key=lambda one: one[0] != socket.AF_INET)]
    return addresses[0]


def _first(*said: str | tuple[str, ...]) -> tuple[str, str, str]:
    """Host, colon and port of the first `address:port` in what sections say; one may say `auto`, or nothing."""
    texts = [one for each in said for one in ((each,) if isinstance(each, str) else each)]
    return next(one for one in texts if ":" in one).rpartition(":")
