"""What a user may set of the colour tracker; its other numbers are in `params`."""

from dataclasses import dataclass
from typing import Annotated

from msgspec import Meta


@dataclass(frozen=True, slots=True)
class ColourSection:
    """What is believed, and what is learned.

    learn_shape: whether the wearer's proportions are refined over the first seconds of good tracking
    live_match: share of the drawn shirt whose colour a picture must have for the pose to be believed
    accept_match: the same for a person who is found anew, where colours in the wrong place count too
    """

    learn_shape: bool = True
    live_match: Annotated[float, Meta(gt=0.0, lt=1.0)] = 0.45
    accept_match: Annotated[float, Meta(gt=0.0, lt=1.0)] = 0.58
