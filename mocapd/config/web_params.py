"""What a user may set of the page in the browser."""

from dataclasses import dataclass
from typing import Annotated

from msgspec import Meta


@dataclass(frozen=True, slots=True)
class Params:
    """The page with the setup and the live view, on this machine only (127.0.0.1).

    enabled: serve the page
    port: its TCP port; 0: a free one, told when it starts
    """

    enabled: bool = True
    port: Annotated[int, Meta(ge=0, le=65535)] = 0
