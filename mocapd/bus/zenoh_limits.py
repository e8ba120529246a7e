"""Limits of a Zenoh session for its peers: bytes, connections and time.

Zenoh's defaults suit a network of trusted machines. A peer of this session may be a hanging game, or an attacker.
"""

from typing import Any

# Of others come queries and declarations of some hundred bytes. A larger message is put together
# in memory before access control sees it; Zenoh's own limit is 1 GiB.
MAX_MESSAGE_BYTES = 65_536

# Games and tools that are connected at once; Zenoh's own limit is 1000.
MAX_SESSIONS = 64

# Connections that have said nothing yet hold a file descriptor and one of these places. Zenoh's own
# 100 places for 10 s are soon taken by a hundred silent connections.
ACCEPT_PENDING = 512
# a handshake takes some milliseconds, and some tenths of a second by radio
ACCEPT_TIMEOUT_MS = 2_000

# Closing takes some milliseconds, but 10 s if a single peer does not read.
CLOSE_S = 0.7


def unicast_limits() -> dict[str, Any]:
    """The part `transport/unicast` of Zenoh's configuration."""
    return {
        "max_sessions": MAX_SESSIONS,
        "accept_pending": ACCEPT_PENDING,
        "accept_timeout": ACCEPT_TIMEOUT_MS,
    }


def receive_limits() -> dict[str, Any]:
    """The part `transport/link/rx` of Zenoh's configuration."""
    return {"max_message_size": MAX_MESSAGE_BYTES}
