"""Warnings about permitted but unsafe Zenoh parameters."""

from pathlib import Path

from mocapd.boundary.secret_files import narrowing, readers_of
from mocapd.outputs.zenoh.zenoh_config import ENCRYPTED, Params, is_loopback

SECRETS = ("tls_private_key", "password_file")


def warnings(params: Params) -> tuple[str, ...]:
    """A warning with its fix for each unsafe setting; reads the files' modes now."""
    texts = [_readable(name, str(getattr(params, name))) for name in SECRETS]
    texts += [_open_to_a_network(params, endpoint) for endpoint in params.listen]
    return tuple(text for text in texts if text)


def _readable(name: str, path: str) -> str:
    """Empty when the file's permissions are narrow enough, or it is gone (then opening the session fails)."""
    readers = readers_of(Path(path)) if path else ""
    return f"zenoh.{name}: {readers} may read {path} -- {narrowing(Path(path))}" if readers else ""


def _open_to_a_network(params: Params, endpoint: str) -> str:
    """Empty for an endpoint on this machine, or one with encryption and client authentication."""
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
