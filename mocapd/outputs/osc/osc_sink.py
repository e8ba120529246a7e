"""Skeleton frames as native OSC over UDP; see `osc_frame` for the addresses."""

import errno
import ipaddress
import os
import socket
from collections.abc import Sequence
from dataclasses import dataclass

from mocapd.errors import ConfigError, UnavailableError
from mocapd.outputs.base import SinkStatus
from mocapd.outputs.messages import StateMessage
from mocapd.outputs.osc.osc_frame import FrameBundles, Shape, shape_of
from mocapd.outputs.wire import SkeletonFrame

KEY = "osc.destinations"
NO_RECEIVER = "no receiver"  # of a destination whose port refuses
SENDING = "sending to"  # another machine, which need not refuse
MAX_LAYOUTS = 32  # cached bundle layouts; cameras and tracking states come and go


@dataclass(frozen=True, slots=True)
class Params:
    """destinations: `address:port`, numeric addresses only. Raises ConfigError otherwise."""

    destinations: tuple[str, ...] = ("127.0.0.1:39541",)

    def __post_init__(self) -> None:
        for destination in self.destinations:
            parse_destination(destination)


def parse_destination(text: str, key: str = KEY) -> tuple[str, int]:
    """`127.0.0.1:39541` or `[::1]:39541` to address and port. Raises ConfigError about this key.

    Names are refused: a look-up may block, and `localhost` may mean ::1, where few games listen.
    """
    address, _, port = text.rpartition(":")
    address = address.removeprefix("[").removesuffix("]")
    try:
        ipaddress.ip_address(address)
        number = int(port)
    except ValueError as error:
        raise _bad_destination(text, key) from error
    if not 0 < number < 65536:
        raise _bad_destination(text, key)
    return address, number


def _bad_destination(text: str, key: str) -> ConfigError:
    return ConfigError(
        f"{text!r} is no numeric address and port",
        key,
        "write for example 127.0.0.1:39541 (not localhost)",
    )


class Destination:
    """One connected UDP socket. On this machine the system reports a port without listener (ECONNREFUSED).

    The report comes after the refused datagram. So a frame counts as sent until the next call, and two frames in a
    row without refusal prove a listener.
    """

    def __init__(self, text: str, key: str = KEY) -> None:
        self.text = text
        address, port = parse_destination(text, key)
        self.is_local = ipaddress.ip_address(address).is_loopback
        self.sent = 0
        self.refused = 0
        self._trouble = "nothing sent yet"
        self._in_a_row = 0
        family = socket.AF_INET6 if ":" in address else socket.AF_INET
        self._socket = socket.socket(family, socket.SOCK_DGRAM)
        try:
            self._socket.setblocking(False)
            self._socket.connect((address, port))
        except OSError as error:
            self._socket.close()
            raise UnavailableError(
                f"no way to {text}: {error.strerror}", key, "check the address"
            ) from error

    def send(self, datagrams: list[bytearray]) -> None:
        """Send the datagrams of one frame, or count it as refused. Never blocks, never raises."""
        # the error of the previous frame; reading clears it, else this frame's send would fail
        error_number = self._socket.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
        if error_number:
            self.sent -= 1
            self._refuse(error_number)
        try:
            for datagram in datagrams:
                self._socket.send(datagram)
        except OSError as error:  # refused, no route, buffer full: all may be temporary
            self._refuse(error.errno or 0)
            return
        self.sent += 1
        self._in_a_row += 1

    def _refuse(self, number: int) -> None:
        self.refused += 1
        self._in_a_row = 0
        self._trouble = NO_RECEIVER if number == errno.ECONNREFUSED else os.strerror(number)

    @property
    def is_heard(self) -> bool:
        """True while frames leave without refusal; proves a listener only on this machine."""
        return self._in_a_row >= 2

    @property
    def detail(self) -> str:
        """One line for people."""
        if not self.is_heard:
            return f"{self._trouble} on {self.text}"
        return f"receiver on {self.text}" if self.is_local else f"{SENDING} {self.text}"

    def close(self) -> None:
        self._socket.close()


def status_of(destinations: Sequence[Destination]) -> SinkStatus:
    """The sum over all destinations; `listeners` is -1 if none on this machine listens and some are on others."""
    heard = sum(d.is_heard for d in destinations if d.is_local)
    is_known = heard or all(d.is_local for d in destinations)
    return SinkStatus(
        sent=sum(d.sent for d in destinations),
        refused=sum(d.refused for d in destinations),
        listeners=heard if is_known else -1,
        detail="; ".join(d.detail for d in destinations) or "closed",
    )


class OscSink:
    """Sends every frame to every destination. Frames without a listener are counted, not an error."""

    name = "osc"

    def __init__(self, params: Params) -> None:
        self._params = params
        self._destinations: tuple[Destination, ...] = ()
        self._layouts: dict[Shape, FrameBundles] = {}

    def open(self) -> None:
        """Open the sockets. Raises UnavailableError for an address without a route."""
        self.close()
        self._destinations = tuple(Destination(text) for text in self._params.destinations)

    def send(self, frame: SkeletonFrame) -> None:
        """Send one frame, as one bundle or several of at most 1472 bytes."""
        shape = shape_of(frame)
        layout = self._layouts.get(shape)
        if layout is None:
            if len(self._layouts) >= MAX_LAYOUTS:
                self._layouts.clear()
            layout = self._layouts[shape] = FrameBundles(frame)
        datagrams = layout.fill(frame)
        for destination in self._destinations:
            destination.send(datagrams)

    def send_state(self, message: StateMessage) -> None:
        """Sends nothing: a datagram would not reach later receivers, and frames hold what they need."""

    def status(self) -> SinkStatus:
        """Frames over all destinations."""
        return status_of(self._destinations)

    def close(self) -> None:
        """Close the sockets; may be called twice."""
        for destination in self._destinations:
            destination.close()
        self._destinations = ()
