"""The UDP socket to wherever VRChat is now."""

from mocapd.errors import UnavailableError
from mocapd.outputs.base import SinkStatus
from mocapd.outputs.osc.osc_sink import Destination

KEY = "vrchat.destination"


class VRChatLink:
    """Frames are counted on when it is aimed elsewhere. `status` from any thread, the rest from one at a time."""

    def __init__(self) -> None:
        self._destination: Destination | None = None
        self._aim: str | None = None
        self._sent = self._refused = 0  # to where it was aimed before

    def aim(self, address: str | None) -> None:
        """From now on there, `address:port`; None: nowhere. Raises UnavailableError where no way leads: once, until
        it is aimed elsewhere."""
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
        """Whether it is known where VRChat is."""
        return self._destination is not None

    def send(self, datagram: bytearray) -> None:
        """One frame, while it is aimed."""
        if self._destination is not None:
            self._destination.send([datagram])

    def refuse(self) -> None:
        """Count a frame for which it is aimed nowhere."""
        self._refused += 1

    def status(self) -> SinkStatus:
        """Of all frames; `listeners` is -1 on other machines, which cannot be asked."""
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
