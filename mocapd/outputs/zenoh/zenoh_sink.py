"""Skeleton frames on Zenoh: key `mocapd/v1/<instance>/skeleton/<person>`."""

import logging
from contextlib import ExitStack
from typing import Any

import zenoh

from mocapd.bus.zenoh_close import close_soon
from mocapd.bus.zenoh_linger import close_at_once
from mocapd.clock import NS_PER_S, monotonic_ns
from mocapd.outputs import wire
from mocapd.outputs.base import SinkStatus
from mocapd.outputs.instance import instance_name
from mocapd.outputs.messages import StateMessage
from mocapd.outputs.socket_owners import owners_of
from mocapd.outputs.wire import SkeletonFrame
from mocapd.outputs.zenoh import keys
from mocapd.outputs.zenoh.zenoh_config import Params, listen_endpoints
from mocapd.outputs.zenoh.zenoh_open import open_session
from mocapd.outputs.zenoh.zenoh_state import ZenohState
from mocapd.outputs.zenoh.zenoh_warnings import warnings

# Validity of a positive subscriber check, because the check costs more than a send [ns].
_HEARD_NS = NS_PER_S // 10

_log = logging.getLogger(__name__)


class ListenerNames:
    """Names the clients' sessions by their process, or by their address on another machine.

    Do not query the session's admin space for the subscribers among them. It holds the routing tables' read lock while it
    answers and takes the lock again for each reply: a subscriber declared between the two deadlocks the session
    (reproduced with eclipse-zenoh 1.10.2 within seconds).

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


class ZenohSink:
    """Publishes frames, answers late joiners, and holds a liveliness token.

    `send` from one thread; `send_state` and `status` from any. Without subscribers, frames are not encoded.
    """

    name = "zenoh"

    def __init__(self, params: Params, instance: str = "") -> None:
        """instance: the daemon's name in the keys; empty: the machine's."""
        self._params = params
        self.instance = instance_name(instance)
        self._json = params.format == "json"
        self._state = ZenohState(self.instance, params.format)
        self._listener_names = ListenerNames()
        self._session: zenoh.Session | None = None
        self._opened = ExitStack()
        self._publishers: dict[int, zenoh.Publisher] = {}
        self._heard_until_ns: dict[int, int] = {}  # by person
        self._sent = 0
        self._unheard = 0

    def open(self) -> None:
        """Open the session. Raises UnavailableError, which names the holder of a taken port."""
        for text in warnings(self._params):
            _log.warning("%s", text)
        session = self._opened.enter_context(open_session(self._params))
        self._opened.enter_context(close_at_once(session))
        self._state.attach(session, self._opened)
        # undeclaring a publisher sends to every client, so it belongs to the close
        self._opened.callback(self._publishers.clear)
        self._publishers[0] = self._declare(session, 0)
        # last in, first out: while the token exists, everything else does
        self._opened.enter_context(session.liveliness().declare_token(keys.alive(self.instance)))
        self._session = session

    def _declare(self, session: zenoh.Session, person: int) -> zenoh.Publisher:
        return session.declare_publisher(
            keys.skeleton(self.instance, person),
            encoding=wire.JSON if self._json else wire.MSGPACK,
            # drop a frame that cannot be sent now instead of waiting; do not delay it for a batch
            congestion_control=zenoh.CongestionControl.DROP,
            priority=zenoh.Priority.REAL_TIME,
            express=True,
        )

    def send(self, frame: SkeletonFrame) -> None:
        """Publish one frame if its person has a subscriber; does nothing before `open`."""
        session = self._session
        if session is None:
            return
        publisher = self._publishers.get(frame.person)
        if publisher is None:
            publisher = self._publishers[frame.person] = self._declare(session, frame.person)
        now_ns = monotonic_ns()
        if now_ns >= self._heard_until_ns.get(frame.person, 0):
            if not _is_heard(publisher):
                self._unheard += 1
                return
            self._heard_until_ns[frame.person] = now_ns + _HEARD_NS
        publisher.put(wire.encode_json(frame) if self._json else wire.encode_msgpack(frame))
        self._sent += 1

    def send_state(self, message: StateMessage) -> None:
        """Publish the state, and store it for late joiners."""
        self._state.set(message)

    def status(self) -> SinkStatus:
        """`refused` counts the frames without a subscriber; `listeners` the connected programs, while at least one
        of them subscribes."""
        session = self._session
        if session is None:
            return SinkStatus(self._sent, self._unheard, 0, "closed")
        heard = any(_is_heard(publisher) for publisher in list(self._publishers.values()))
        if self._params.connect:
            # the subscribers are behind the router: we only see whether there are any
            detail = f"joined {', '.join(self._params.connect)}"
            return SinkStatus(
                self._sent,
                self._unheard,
                -1 if heard else 0,
                detail if heard else f"{detail}, nobody listens",
            )
        names = self._listener_names.of(session) if heard else ()
        detail = (
            ", ".join(names) or f"nobody listens on {', '.join(listen_endpoints(self._params))}"
        )
        return SinkStatus(self._sent, self._unheard, len(names), detail)

    def close(self) -> None:
        """Withdraw the token, so that clients notice the end, then close everything else.

        Takes about a second at most, whatever the clients do.
        """
        self._session = None
        self._publishers, self._heard_until_ns = {}, {}
        self._state.detach()
        close_soon(self._opened)


def _is_heard(publisher: zenoh.Publisher) -> bool:
    status: Any = publisher.matching_status  # Zenoh's stub calls it a bool; it is an object
    return bool(status.matching)
