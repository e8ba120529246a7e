"""Limits of a Zenoh session for its peers: bytes, connections, time and threads.

Zenoh's defaults suit a network of trusted machines. A peer of this session may be a hanging game, or an attacker.
"""

import os
from typing import Any

# Of others come queries and declarations of some hundred bytes. A larger message is put together
# in memory before access control sees it; Zenoh's own limit is 1 GiB.
MAX_MESSAGE_BYTES = 65_536

# Games and tools that are connected at once; Zenoh's own limit is 1000.
MAX_SESSIONS = 64

# Connections that have said nothing yet hold a file descriptor and one of these places. Zenoh's own
# 100 places for 10 s are soon taken by a hundred silent connections.
ACCEPT_PENDING = 512
ACCEPT_TIMEOUT_MS = (
    2_000  # a handshake takes some milliseconds, and some tenths of a second by radio
)

# Zenoh closes the connection of a game that hangs with a call that waits up to 10 s for the bytes
# that the game does not take (SO_LINGER), on one of the threads that also serve newcomers. So
# there is one for each game and some more; one that waits costs 20 kB. Zenoh's own are 2.
RX_THREADS = MAX_SESSIONS + 16
RUNTIME_VARIABLE = "ZENOH_RUNTIME"
RUNTIME = f"(rx: (worker_threads: {RX_THREADS}))"
# Zenoh reads it when the first session of the process opens. What the user has set is left alone.
os.environ.setdefault(RUNTIME_VARIABLE, RUNTIME)

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
