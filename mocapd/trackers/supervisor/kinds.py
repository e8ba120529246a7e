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


# Of 95 frames in 100 of seven captures with two cameras and more the shirt's quality is above 0.65, and always above 0.57;
# a jacket that is put on goes through 0.5 within a tenth of a second. Without the shirt it hangs on the clothes: always above
# 0.53 in four captures, 0.47 in a fifth and in a jacket over another's colours.
KINDS: Mapping[str, Kind] = MappingProxyType(
    {
        "colour": Kind(upper_only=True, least_cameras=1, good=0.62, poor=0.5),
        "flex": Kind(upper_only=False, least_cameras=2, good=0.5, poor=0.4),
    }
)
