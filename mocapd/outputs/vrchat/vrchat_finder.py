"""Finds VRChat in the local network by OSCQuery, and follows it when it starts anew on other ports.

VRChat announces an HTTP service of the type `_oscjson._tcp` by multicast DNS; that says where it listens for OSC.
Whoever is in the network can announce one: what they say is checked, and only addresses of local networks are asked
and sent to.
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
LOOK_AGAIN_S = 2.0  # while what was announced does not answer [s]
RENEW_S = 60.0  # without any announcement, in case the network is another by now [s]
RESOLVE_MS = 1000
MOST_KNOWN = 16  # services, and announcements that wait
STOP_S = 0.5  # what ending may take; an answer that is waited for is left [s]

_log = logging.getLogger(__name__)


class VRChatFinder:
    """Looks from `start` to `stop`, in a thread of its own. Of several the one that was announced last counts, as
    that is the one that was just started. `address` and `detail` from any thread."""

    def __init__(self, interfaces: Sequence[str] | None = None) -> None:
        """interfaces: addresses of this machine by which to look; None: all."""
        self._interfaces = interfaces
        self.address: str | None = None  # `address:port`, None while none is known
        self.detail = "not looked for yet"
        self._source = ""  # the service that gave the address
        self._announcements: Queue[tuple[str, bool]] = Queue()
        self._ended = threading.Event()
        self._thread: threading.Thread | None = None

    def start(self) -> None:
        """Returns at once. Raises MissingExtraError where its library is not installed."""
        require_extra(
            "vrchat", "vrchat.destination", "give VRChat's address, such as 127.0.0.1:9000"
        )
        self._ended.clear()
        self._thread = threading.Thread(target=self._run, name="vrchat-finder", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Look no more; may be called twice."""
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
        """Until it ends, or has heard nothing for long."""
        from zeroconf import ServiceBrowser

        known: dict[str, None] = {}  # in the order of their announcement
        is_asked = True  # whether all that is known has been asked
        heard_s = time.monotonic()
        ServiceBrowser(network, SERVICE, handlers=[self._announced])
        while not self._ended.is_set():
            try:
                name, is_there = self._announcements.get(timeout=LOOK_AGAIN_S)
                known.pop(name, None)
                if is_there:
                    known[name] = None
                elif name == self._source:
                    self._set(None, "")
                heard_s, is_asked = time.monotonic(), False
            except Empty:
                if not known and time.monotonic() - heard_s > RENEW_S:
                    return
            for oldest in list(known)[:-MOST_KNOWN]:
                del known[oldest]
            if known and not is_asked and not self._ended.is_set():
                is_asked = self._ask(network, list(reversed(known)))

    def _announced(self, **heard: Any) -> None:
        """Of one service, in a thread of zeroconf's, whose words are `name` and `state_change`."""
        name, change = heard["name"], heard["state_change"]
        if name.startswith(PREFIX) and self._announcements.qsize() < MOST_KNOWN:
            self._announcements.put((name, change.name != "Removed"))

    def _ask(self, network: "Zeroconf", names: Sequence[str]) -> bool:
        """Whether one of these tells where it listens; until one does, it stays where it was."""
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
    """Where a service may be asked, this machine first: numeric addresses of local networks."""
    import zeroconf

    try:
        info = network.get_service_info(SERVICE, name, RESOLVE_MS)
    except zeroconf.Error:  # such as a name that is none
        return []
    if info is None or not info.port:
        return []
    addresses = info.addresses_by_version(zeroconf.IPVersion.V4Only)
    found = [ipaddress.IPv4Address(one) for one in addresses]
    local = [one for one in found if is_of_local_network(one)]
    return [(str(one), info.port) for one in sorted(local, key=lambda one: not one.is_loopback)]


def is_of_local_network(address: ipaddress.IPv4Address) -> bool:
    """Whether it is of one machine in a local network."""
    return address.is_private and not (
        address.is_multicast or address.is_unspecified or address.is_reserved
    )
