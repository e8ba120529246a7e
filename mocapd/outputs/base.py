"""The interface of every output."""

from dataclasses import dataclass
from typing import Protocol

from mocapd.outputs.messages import StateMessage
from mocapd.outputs.wire import SkeletonFrame


@dataclass(frozen=True, slots=True)
class SinkStatus:
    """`listeners`: number of listeners, -1 where the protocol does not show it; `detail`: one line for the status view."""

    sent: int
    refused: int
    listeners: int
    detail: str


class Sink(Protocol):
    """One output. One thread calls `send`; any thread calls `send_state`, also before `open`. No listener is no error."""

    name: str

    def open(self) -> None:
        """Open sockets. Raises UnavailableError with the mend (a taken port names its holder)."""
        ...

    def send(self, frame: SkeletonFrame) -> None:
        """Send one frame; never blocks longer than a millisecond or two."""
        ...

    def send_state(self, message: StateMessage) -> None:
        """Send or store the newest state; a sink without a use for it ignores it. As quick as `send`."""
        ...

    def status(self) -> SinkStatus: ...

    def close(self) -> None:
        """Release everything; may be called twice."""
        ...
