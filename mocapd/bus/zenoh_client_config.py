"""The Zenoh session of a program that listens to a daemon."""

from typing import Any


def client_config(
    endpoint: str,
    *,
    timeout_s: float,
    tls_root_ca: str = "",
    user: str = "",
    password: str = "",
    certificate: str = "",
    private_key: str = "",
) -> dict[str, Any]:
    """Zenoh's configuration for a program that connects to `endpoint` and listens nowhere.

    certificate, private_key: PEM files of this program, for one who asks for them.
    """
    return {
        "mode": "client",
        "connect": {"endpoints": [endpoint], "timeout_ms": round(timeout_s * 1000)},
        "scouting": {"multicast": {"enabled": False}, "gossip": {"enabled": False}},
        "transport": {
            "shared_memory": {"enabled": False},
            "link": {
                "tls": {
                    "root_ca_certificate": tls_root_ca or None,
                    "enable_mtls": bool(certificate),
                    "connect_certificate": certificate or None,
                    "connect_private_key": private_key or None,
                }
            },
            "auth": {"usrpwd": {"user": user or None, "password": password or None}},
        },
    }
