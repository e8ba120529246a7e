"""What a user may set of the canned tracker."""

from dataclasses import dataclass
from typing import Annotated

from msgspec import Meta


@dataclass(frozen=True, slots=True)
class CannedSection:
    """The loop.

    loop_s: duration of one loop [s]
    waves: how often the left hand waves in it
    sway_m: how far the hips move to each side [m]
    """

    loop_s: Annotated[float, Meta(ge=0.1, le=3600.0)] = 4.0
    waves: Annotated[int, Meta(ge=0, le=1000)] = 6
    sway_m: Annotated[float, Meta(ge=0.0, le=1.0)] = 0.06
