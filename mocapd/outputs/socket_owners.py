"""Which process is at a local TCP port: to name who holds one, or who listens to us."""

import psutil


def holder_of(port: int) -> str:
    """Who listens on a local TCP port: `zenohd (pid 12)`; empty when nobody or not visible to us."""
    for connection in psutil.net_connections("tcp"):
        if connection.status == psutil.CONN_LISTEN and connection.laddr.port == port:
            return describe(connection.pid)
    return ""


def owners_of(ports: frozenset[int]) -> dict[int, str]:
    """Who is at each of these local TCP ports (connected, not listening), where visible to us."""
    return {
        connection.laddr.port: describe(connection.pid)
        for connection in psutil.net_connections("tcp")
        if connection.laddr and connection.laddr.port in ports and connection.pid is not None
    }


def describe(pid: int | None) -> str:
    """`name (pid 12)`; empty for a process that is not visible to us."""
    if pid is None:
        return ""
    try:
        return f"{psutil.Process(pid).name()} (pid {pid})"
    except (psutil.NoSuchProcess, psutil.AccessDenied):
        return f"pid {pid}"
