"""What is permitted and yet unsafe in the Zenoh parameters, one line each."""

from pathlib import Path

from mocapd.boundary.secret_files import narrowing, readers_of
from mocapd.outputs.zenoh.zenoh_config import ENCRYPTED, Params, is_loopback

SECRETS = ("tls_private_key", "password_file")


def warnings(params: Params) -> tuple[str, ...]:
    """A sentence with its mend for each unsafe setting; looks at the files' modes now."""
    found = [_readable(name, str(getattr(params, name))) for name in SECRETS]
    found += [_open_to_a_network(params, endpoint) for endpoint in params.listen]
    return tuple(text for text in found if text)


def _readable(name: str, path: str) -> str:
    """Empty when only those who must may read the file, or it is gone: opening the session tells."""
    who = readers_of(Path(path)) if path else ""
    return f"zenoh.{name}: {who} may read {path} -- {narrowing(Path(path))}" if who else ""


def _open_to_a_network(params: Params, endpoint: str) -> str:
    """Empty when the endpoint stays on this machine, or encrypts and knows its clients."""
    if is_loopback(endpoint):
        return ""
    if endpoint.partition("/")[0] not in ENCRYPTED:
        others = "it asks for a password, but others" if params.password_file else "others"
        return (
            f"zenoh.listen: {endpoint} encrypts nothing: {others} on the way can read -- use tls/"
        )
    if params.password_file or params.tls_require_client:
        return ""
    return (
        f"zenoh.listen: {endpoint} lets everybody who reaches it read the stream -- "
        "set zenoh.password_file or zenoh.tls_require_client"
    )
