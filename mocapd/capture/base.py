"""The interface of every camera source."""

from typing import Protocol

from mocapd.types import Frame


class Source(Protocol):
    """One camera. Used by one thread, except `close`, which any thread may call to wake a blocked `read`.

    `recorded` sources hand out frames of the past: they end, and can be read faster than real time.
    """

    name: str
    recorded: bool

    def open(self) -> None:
        """Get ready to read. Raises UnavailableError, PermissionDeniedError or InputError."""
        ...

    def read(self) -> Frame:
        """The next frame, waiting for it. Raises CameraLost (reopen it) or EndOfStream (it is over)."""
        ...

    def close(self) -> None:
        """Let go of the camera; may be called twice, and when open failed."""
        ...
