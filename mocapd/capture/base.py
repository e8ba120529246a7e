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
        """Get ready to read. Raises UnavailableError, PermissionDeniedError or InputError."""
        ...

    def read(self) -> Frame:
        """The next frame, waiting for it. Raises CameraLost (reopen it) or EndOfStream (it is over)."""
        ...

    def close(self) -> None:
        """Let go of the camera; may be called twice, and when open failed. An `open` that is still going on gives up
        what it got; a `read` that comes back later than the next `open` touches nothing of that."""
        ...


@runtime_checkable
class CountsTorn(Protocol):
    """A source that leaves out damaged frames and counts them."""

    torn: int


@runtime_checkable
class Notices(Protocol):
    """A source that knows what is wrong with its pictures beyond what they show."""

    @property
    def notice(self) -> str:
        """One line for people, the same while the trouble is; empty when there is none. By the thread that reads."""
        ...


@runtime_checkable
class LookedAfter(Protocol):
    """A source whose camera somebody else opens again, and leaves out when that does not help: what fails there is
    counted there alone."""

    camera_failed: bool
    """Whether the last loss was of that kind, and not one of the way to it. Read by the thread that reads."""


@runtime_checkable
class Pluggable(Protocol):
    """A source whose camera has a plug. From any thread, quickly, without opening it."""

    def plugging(self) -> str:
        """Another word after each plugging in; empty while it is not there, or not known among others."""
        ...

    @property
    def identity(self) -> WebcamIdentity | None:
        """What it is sought by; None for one that is sought by its node. Raises InputError or ConfigError."""
        ...

    @property
    def place(self) -> str:
        """Where it was found when it was opened, for people; empty where it was expected."""
        ...
