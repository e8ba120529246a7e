"""The interface of every camera source."""

from typing import Protocol, runtime_checkable

from mocapd.capture.webcam.identity import WebcamIdentity
from mocapd.types import Frame


class Source(Protocol):
    """One camera. Used by one thread, except `close`, which any thread may call to wake a blocked `read`.

    `recorded` sources hand out frames of the past: they end, and can be read faster than real time.
    """

    name: str
    recorded: bool

    def open(self) -> None:
        """Prepares reading. Raises UnavailableError, PermissionDeniedError or InputError."""
        ...

    def read(self) -> Frame:
        """The next frame, waiting for it. Raises CameraLost (reopen it), CameraClosed (the same, on request), or EndOfStream
        (it is over)."""
        ...

    def close(self) -> None:
        """Releases the camera; idempotent, and valid after a failed `open`. A concurrent `open` releases its device again;
        a stale `read` that returns after the next `open` does not affect the new device."""
        ...


@runtime_checkable
class CountsTorn(Protocol):
    """A source that drops damaged frames and counts them."""

    torn: int


@runtime_checkable
class Notices(Protocol):
    """A source that reports trouble which the pictures themselves do not show."""

    @property
    def notice(self) -> str:
        """One line for users, constant while the trouble lasts; empty without trouble. Call from the reading thread."""
        ...


@runtime_checkable
class NodeManaged(Protocol):
    """A source whose camera a camera node reopens and quarantines: failures of the camera itself count at the node
    only."""

    camera_failed: bool
    """True if the last loss was a failure of the camera, not of the network. Read from the reading thread."""


@runtime_checkable
class Pluggable(Protocol):
    """A source whose camera can be unplugged. Thread-safe, fast, does not open the camera."""

    def plugging(self) -> str:
        """An id that changes with each plugging in; empty while the camera is absent or ambiguous."""
        ...

    @property
    def identity(self) -> WebcamIdentity | None:
        """The USB identity; None for a camera addressed by its node. Raises InputError or ConfigError."""
        ...

    @property
    def place(self) -> str:
        """The camera's location at the last `open`, for users; empty at the expected location."""
        ...
