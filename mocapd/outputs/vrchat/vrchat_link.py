"""The UDP socket to VRChat's current address."""

from mocapd.errors import UnavailableError
from mocapd.outputs.base import SinkStatus
from mocapd.outputs.osc.osc_sink import Destination

KEY = "vrchat.destination"


class VRChatLink:
    """Counts frames over all addresses. `status` from any thread, the rest from one at a time."""

    def __init__(self) -> None:
        self._destination: Destination | None = None
        self._aim: str | None = None
        self._sent = self._refused = 0  # to earlier addresses

    def aim(self, address: str | None) -> None:
        """Set the address, `address:port`; None: no address. Raises UnavailableError for an address without a route, once
        for each change."""
        if address == self._aim:
            return
        self.close()
        self._aim = address
        if address is None:
            return
        try:
            self._destination = Destination(address)
        except UnavailableError as error:
            raise UnavailableError(error.what, KEY, error.fix) from None

    @property
    def is_aimed(self) -> bool:
        """True while it has an address."""
        return self._destination is not None

    def send(self, datagram: bytearray) -> None:
        """Send one frame, if it has an address."""
        if self._destination is not None:
            self._destination.send([datagram])

    def refuse(self) -> None:
        """Count a frame without an address as refused."""
        self._refused += 1

    def status(self) -> SinkStatus:
        """Counts of all frames; `listeners` is -1 for an address on another machine."""
        there = self._destination
        if there is None:
            return SinkStatus(self._sent, self._refused, 0, "closed")
        return SinkStatus(
            self._sent + there.sent,
            self._refused + there.refused,
            int(there.is_heard) if there.is_local else -1,
            there.detail,
        )

    def close(self) -> None:
        """Close the socket; may be called twice."""
        there, self._destination, self._aim = self._destination, None, None
        if there is not None:
            self._sent, self._refused = self._sent + there.sent, self._refused + there.refused
            there.close()
