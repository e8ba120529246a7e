"""Finds VRChat in the local network by OSCQuery, also after a restart on other ports.

VRChat announces an HTTP service of the type `_oscjson._tcp` by multicast DNS, and the service returns the port for OSC.
Any host in the network can announce such a service. So answers are checked, and only addresses of local networks are
queried and used.
"""

import ipaddress
import logging
import threading
import time
from collections.abc import Sequence
from queue import Empty, Queue
from typing import TYPE_CHECKING, Any

from mocapd.errors import UnavailableError
from mocapd.extras import require_extra
from mocapd.outputs.vrchat.host_info import PREFIX, ask_host_info

if TYPE_CHECKING:
    from zeroconf import Zeroconf

SERVICE = "_oscjson._tcp.local."
LOOK_AGAIN_S = 2.0  # retry interval while an announced service does not answer [s]
RENEW_S = 60.0  # without announcements, then Zeroconf restarts: the network may have changed [s]
RESOLVE_MS = 1000
MOST_SERVICES = 16  # also the limit of queued announcements
STOP_S = 0.5  # limit of `stop`; a pending query is abandoned [s]

_log = logging.getLogger(__name__)


class VRChatFinder:
    """Searches from `start` to `stop` in its own thread. Of several services the newest one counts, because that VRChat
    was just started. Read `address` and `detail` from any thread."""

    def __init__(self, interfaces: Sequence[str] | None = None) -> None:
        """interfaces: addresses of this machine's interfaces to search on; None: all."""
        self._interfaces = interfaces
        self.address: str | None = None  # `address:port`; None: not found
        self.detail = "not looked for yet"
        self._source = ""  # the service that gave the address
        self._announcements: Queue[tuple[str, bool]] = Queue()
        self._ended = threading.Event()
        self._thread: threading.Thread | None = None

    def start(self) -> None:
        """Start the search; returns at once. Raises MissingExtraError where its library is not installed."""
        require_extra(
            "vrchat", "vrchat.destination", "give VRChat's address, such as 127.0.0.1:9000"
        )
        self._ended.clear()
        self._thread = threading.Thread(target=self._run, name="vrchat-finder", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Stop the search; may be called twice."""
        self._ended.set()
        self._announcements.put(("", False))
        if self._thread is not None:
            self._thread.join(STOP_S)
            self._thread = None
        self._set(None, "")

    def _run(self) -> None:
        from zeroconf import InterfaceChoice, Zeroconf

        chosen: Any = InterfaceChoice.All if self._interfaces is None else [*self._interfaces]
        while not self._ended.is_set():
            try:
                with Zeroconf(interfaces=chosen) as network:
                    self.detail = "looking for VRChat in the local network"
                    self._look(network)
            except OSError as error:
                self.detail = f"VRChat cannot be looked for: {error.strerror or error}"
                self._ended.wait(LOOK_AGAIN_S)

    def _look(self, network: "Zeroconf") -> None:
        """Search until `stop`, or RENEW_S without an announcement."""
        from zeroconf import ServiceBrowser

        services: dict[str, None] = {}  # in the order of their announcement
        is_asked = True  # whether these services have been queried
        heard_s = time.monotonic()
        ServiceBrowser(network, SERVICE, handlers=[self._on_announcement])
        while not self._ended.is_set():
            try:
                name, is_there = self._announcements.get(timeout=LOOK_AGAIN_S)
                services.pop(name, None)
                if is_there:
                    services[name] = None
                elif name == self._source:
                    self._set(None, "")
                heard_s, is_asked = time.monotonic(), False
            except Empty:
                if not services and time.monotonic() - heard_s > RENEW_S:
                    return
            for oldest in list(services)[:-MOST_SERVICES]:
                del services[oldest]
            if services and not is_asked and not self._ended.is_set():
                is_asked = self._ask(network, list(reversed(services)))

    def _on_announcement(self, **event: Any) -> None:
        """Called in a thread of zeroconf with the keywords `name` and `state_change`."""
        name, change = event["name"], event["state_change"]
        if name.startswith(PREFIX) and self._announcements.qsize() < MOST_SERVICES:
            self._announcements.put((name, change.name != "Removed"))

    def _ask(self, network: "Zeroconf", names: Sequence[str]) -> bool:
        """Set the address from the first service that answers; False, and no change, where none does."""
        for name in names:
            for address, port in _places(network, name):
                try:
                    info = ask_host_info(address, port)
                except UnavailableError as error:
                    self.detail = f"a VRChat was announced, but: {error}"
                    continue
                self._set(f"{address}:{info.osc_port}", name)
                return True
        return False

    def _set(self, address: str | None, source: str) -> None:
        self._source = source
        if address != self.address:
            self.address = address
            if address is not None:
                _log.info("VRChat is at %s", address)
            elif not self._ended.is_set():
                _log.info("VRChat is gone, and looked for")
                self.detail = "looking for VRChat in the local network"


def _places(network: "Zeroconf", name: str) -> list[tuple[str, int]]:
    """The service's numeric addresses in local networks, this machine first."""
    import zeroconf

    try:
        info = network.get_service_info(SERVICE, name, RESOLVE_MS)
    except zeroconf.Error:  # such as an invalid name
        return []
    if info is None or not info.port:
        return []
    addresses = info.addresses_by_version(zeroconf.IPVersion.V4Only)
    local = [ip for ip in map(ipaddress.IPv4Address, addresses) if is_of_local_network(ip)]
    return [(str(ip), info.port) for ip in sorted(local, key=lambda ip: not ip.is_loopback)]


def is_of_local_network(address: ipaddress.IPv4Address) -> bool:
    """True for the address of one machine in a local network."""
    return address.is_private and not (
        address.is_multicast or address.is_unspecified or address.is_reserved
    )
