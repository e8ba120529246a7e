"""What a user may set of the tracker without a shirt; its other numbers are in `params`."""

from dataclasses import dataclass
from typing import Annotated

from msgspec import Meta


@dataclass(frozen=True, slots=True)
class FlexSection:
    """What is believed.

    live_explained: share of the drawn body and of what stands there that agree, for the pose to be believed
    accept_explained: the same of a silhouette that is taken for a person
    """

    live_explained: Annotated[float, Meta(gt=0.0, lt=1.0)] = 0.45
    accept_explained: Annotated[float, Meta(gt=0.0, lt=1.0)] = 0.75
