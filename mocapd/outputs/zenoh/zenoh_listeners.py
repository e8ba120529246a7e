"""Names the clients connected to the daemon's Zenoh session, for the status line.

Do not query the session's admin space for the subscribers among them. It holds the routing tables' read lock while it
answers and takes the lock again for each reply: a subscriber declared between the two deadlocks the session
(reproduced with eclipse-zenoh 1.10.2 within seconds).
"""

import zenoh

from mocapd.outputs.socket_owners import owners_of


class ListenerNames:
    """Names sessions by their process, or by their address on another machine.

    A process look-up walks every process's sockets, so the names of live sessions are cached.
    """

    def __init__(self) -> None:
        self._names: dict[str, str] = {}

    def of(self, session: zenoh.Session) -> tuple[str, ...]:
        """One name per connected session, such as `godot (pid 12)` or `192.168.1.7`, in a stable order."""
        addresses = {
            str(link.zid): link.dst.partition("/")[2].rpartition(":")
            for link in session.info.links()
        }
        if not addresses.keys() <= self._names.keys():
            self._look_up(addresses)
        self._names = {zid: self._names[zid] for zid in sorted(addresses)}
        return tuple(self._names.values())

    def _look_up(self, addresses: dict[str, tuple[str, str, str]]) -> None:
        local_ports = frozenset(
            int(port) for host, _, port in addresses.values() if host in ("127.0.0.1", "[::1]")
        )
        owners = owners_of(local_ports) if local_ports else {}
        for zid, (host, _, port) in addresses.items():
            local_owner = owners.get(int(port)) if int(port) in local_ports else None
            self._names[zid] = local_owner or host
