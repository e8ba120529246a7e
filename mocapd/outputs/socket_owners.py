"""Names the processes at local TCP ports: the holder of a port, and our clients."""

import os

import psutil

OF_ANOTHER = "a process of another user"


def holder_of(port: int) -> str:
    """The process that listens on a local TCP port: `zenohd (pid 12)`, or OF_ANOTHER; empty without listener."""
    for connection in psutil.net_connections("tcp"):
        if connection.status == psutil.CONN_LISTEN and connection.laddr.port == port:
            return describe(connection.pid) or OF_ANOTHER
    return ""


def listens(pid: int, address: str, port: int) -> bool:
    """True if this process lives, belongs to our user, and itself listens on that local TCP port."""
    try:
        process = psutil.Process(pid)
        if process.uids().real != os.getuid():
            return False
        return any(
            connection.status == psutil.CONN_LISTEN and connection.laddr == (address, port)
            for connection in process.net_connections("tcp")
        )
    except (psutil.NoSuchProcess, psutil.AccessDenied):
        return False


def owners_of(ports: frozenset[int]) -> dict[int, str]:
    """The process connected from each of these local TCP ports, where visible to us."""
    return {
        connection.laddr.port: describe(connection.pid)
        for connection in psutil.net_connections("tcp")
        if connection.laddr and connection.laddr.port in ports and connection.pid is not None
    }


def describe(pid: int | None) -> str:
    """`name (pid 12)`; empty for an invisible process."""
    if pid is None:
        return ""
    try:
        return f"{psutil.Process(pid).name()} (pid {pid})"
    except (psutil.NoSuchProcess, psutil.AccessDenied):
        return f"pid {pid}"
