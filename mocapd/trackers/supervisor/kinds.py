"""The trackers that the supervisor knows how to use, the best first: one line each in KINDS."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType


@dataclass(frozen=True, slots=True)
class Kind:
    """What a tracker is good for.

    upper_only: whether it tells nothing of legs and head, which then are another's; least_cameras: fewer in a frame
    set, and it is not begun with; good: the quality of a track that is believed; poor: below it belief ends.
    """

    upper_only: bool
    least_cameras: int
    good: float
    poor: float


# The shirt of 3 captures: 0.7 to 0.95 while it is open to view, 0.5 and less under half a jacket. Without the shirt the
# share hangs on the clothes: 0.5 to 0.8, and a body that is lost falls below the tracker's own limit at once.
KINDS: Mapping[str, Kind] = MappingProxyType(
    {
        "colour": Kind(upper_only=True, least_cameras=1, good=0.62, poor=0.5),
        "flex": Kind(upper_only=False, least_cameras=2, good=0.5, poor=0.4),
    }
)
