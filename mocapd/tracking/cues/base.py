"""What a cue is: a kind of evidence of where a body is."""

from typing import Protocol

from mocapd.tracking.effort import OptionalWork
from mocapd.tracking.pictures import Pictures
from mocapd.tracking.ticks import Ticks


class Cue(Protocol):
    """What every cue does; what it says of a body depends on the parts that it sees. work: what optional work is done."""

    name: str
    work: OptionalWork

    def reset(self) -> None:
        """Forget background, light and colours."""
        ...

    def rehearse(self) -> None:
        """Compile or load the kernels that only rare frames reach: whoever comes must not wait for them."""
        ...

    def take(self, pictures: Pictures, ticks: Ticks, /) -> None:
        """Take the pictures of a frame set, and the ticks that passed with it."""
        ...
