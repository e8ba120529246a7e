"""The interface of a cue: a kind of evidence for the body's pose."""

from typing import Protocol

from mocapd.tracking.effort import OptionalWork
from mocapd.tracking.pictures import Pictures
from mocapd.tracking.ticks import Ticks


class Cue(Protocol):
    """A cue. What it observes of a body depends on its parts; work: the optional work to do."""

    name: str
    work: OptionalWork

    def reset(self) -> None:
        """Forget background, light and colours."""
        ...

    def rehearse(self) -> None:
        """Compiles or loads the kernels that only rare frames reach, so that no person waits for them."""
        ...

    def take(self, pictures: Pictures, ticks: Ticks, /) -> None:
        """Take the pictures of a frame set, and the ticks that passed with it."""
        ...
