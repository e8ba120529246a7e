"""Who is connected to the daemon's Zenoh session, for the status line.

Which of them subscribe, the session's admin space would say, but must not be asked: it answers while it holds
the routing tables' lock for reading and takes it again for each reply, so that a subscriber that is declared
between the two stops the whole session for good (seen with eclipse-zenoh 1.10.2 within seconds).
"""

import zenoh

from mocapd.outputs.socket_owners import owners_of


class ListenerNames:
    """Names sessions by their process, or by their address when it is on another machine.

    Looking up a process walks every process's sockets, so a name is kept while its session lives.
    """

    def __init__(self) -> None:
        self._names: dict[str, str] = {}

    def of(self, session: zenoh.Session) -> tuple[str, ...]:
        """One name per connected session, such as `godot (pid 12)` or `192.168.1.7`, in a lasting order."""
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
