"""Opens the daemon's Zenoh session, with a one-line error for every refusal."""

import json
from pathlib import Path
from typing import Any

import zenoh

from mocapd.errors import MocapdError, PermissionDeniedError, UnavailableError
from mocapd.outputs.socket_owners import holder_of
from mocapd.outputs.zenoh.zenoh_config import (
    Params,
    listen_endpoints,
    session_config,
    without_options,
)
from mocapd.outputs.zenoh.zenoh_password_file import check_password_file

TAKEN = "os error 98"  # EADDRINUSE in the text of Zenoh's errors, which have no error number
FORBIDDEN = "os error 13"  # EACCES


def open_session(params: Params, config: dict[str, Any] | None = None) -> zenoh.Session:
    """Open the session. Raises UnavailableError or PermissionDeniedError with the fix; for a taken port it names the
    process that holds it.

    config: a Zenoh configuration instead of the daemon's. Raises ConfigError when the password file has become invalid
    since the parameters were checked.
    """
    if params.password_file:
        check_password_file(Path(params.password_file))
    try:
        return zenoh.open(zenoh.Config.from_json5(json.dumps(config or session_config(params))))
    except zenoh.ZError as error:
        raise _explain_error(params, str(error)) from error


def _explain_error(params: Params, text: str) -> MocapdError:
    if params.connect:
        return UnavailableError(
            "no Zenoh router answers",
            ", ".join(params.connect),
            "start it, or leave zenoh.connect empty to be reached without a router",
        )
    where = ", ".join(listen_endpoints(params))
    port_key = "port in zenoh.listen" if params.listen else "zenoh.port"
    if TAKEN in text:
        taken = next((e for e in listen_endpoints(params) if e in text), where)
        port = int(without_options(taken).rpartition(":")[2])
        holder = holder_of(port)
        return UnavailableError(
            f"port {port} is taken by {holder}" if holder else f"port {port} is taken",
            taken,
            f'end it, join it with zenoh.connect = ["tcp/127.0.0.1:{port}"] if it is a Zenoh router, '
            f"or choose another {port_key}",
        )
    if FORBIDDEN in text:
        return PermissionDeniedError(
            "not allowed to listen there", where, f"choose a {port_key} above 1023"
        )
    # after the sentence Zenoh appends the position in its source
    return UnavailableError(
        f"Zenoh does not open: {text.partition(' at /')[0]}", where, "mend zenoh.listen"
    )
