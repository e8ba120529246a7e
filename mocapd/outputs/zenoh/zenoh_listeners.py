"""Who subscribes to the frames, for the status line."""

import json

import zenoh

from mocapd.outputs.socket_owners import owners_of


def subscribers(session: zenoh.Session, key: str) -> tuple[str, ...]:
    """Ids of the remote sessions that subscribe to `key`, sorted.

    Read from this session's own admin space (keys `@/<zid>/<mode>/subscriber/<key expression>`),
    which never leaves the process: about 0.3 ms.
    """
    own = str(session.zid())
    found: set[str] = set()
    for reply in session.get(f"@/{own}/*/subscriber/**"):
        sample = reply.ok
        if sample is None:
            continue
        wanted = str(sample.key_expr).partition("/subscriber/")[2]
        if not zenoh.KeyExpr(wanted).intersects(key):
            continue
        sources = json.loads(sample.payload.to_bytes())
        for kind in ("routers", "peers", "clients"):
            found.update(sources.get(kind, ()))
    return tuple(sorted(found - {own}))


class ListenerNames:
    """Names sessions by their process, or by their address when it is on another machine.

    Looking up a process walks every process's sockets, so a name is kept while its session lives.
    """

    def __init__(self) -> None:
        self._names: dict[str, str] = {}

    def of(self, session: zenoh.Session, zids: tuple[str, ...]) -> tuple[str, ...]:
        """One name per session id, such as `godot (pid 12)` or `192.168.1.7`."""
        if not set(zids) <= self._names.keys():
            self._look_up(session)
        self._names = {zid: self._names.get(zid, "unknown") for zid in zids}
        return tuple(self._names[zid] for zid in zids)

    def _look_up(self, session: zenoh.Session) -> None:
        addresses = {
            str(link.zid): link.dst.partition("/")[2].rpartition(":")
            for link in session.info.links()
        }
        local_ports = frozenset(
            int(port) for host, _, port in addresses.values() if host in ("127.0.0.1", "[::1]")
        )
        owners = owners_of(local_ports) if local_ports else {}
        for zid, (host, _, port) in addresses.items():
            local_owner = owners.get(int(port)) if int(port) in local_ports else None
            self._names[zid] = local_owner or host
