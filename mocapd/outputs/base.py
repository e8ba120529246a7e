"""The interface of every output."""

from dataclasses import dataclass
from typing import Protocol

from mocapd.outputs.messages import StateMessage
from mocapd.outputs.wire import SkeletonFrame


@dataclass(frozen=True, slots=True)
class SinkStatus:
    """`listeners`: how many listen, -1 where the protocol cannot tell; `detail`: one line for the status view."""

    sent: int
    refused: int
    listeners: int
    detail: str


class Sink(Protocol):
    """One output. `send` is called from one thread, `tell` from any, also before `open`; nobody listening is a
    state, not an error."""

    name: str

    def open(self) -> None:
        """Open sockets. Raises UnavailableError with the mend (a taken port names its holder)."""
        ...

    def send(self, frame: SkeletonFrame) -> None:
        """Send one frame; never blocks longer than a millisecond or two."""
        ...

    def tell(self, message: StateMessage) -> None:
        """Take note of a state, of which the newest holds; one that has no use for it does nothing.

        As quick as `send`.
        """
        ...

    def status(self) -> SinkStatus: ...

    def close(self) -> None:
        """Let go; may be called twice."""
        ...
