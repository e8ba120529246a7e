"""A guess at the room behind an adopted body, so that what the body uncovers is recognised at once.

Nobody has seen the room there. As long as all of it counts as the person, limbs that leave it do not seem to move.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from mocapd.types import Bytes

_REACH_PX = 5.0  # the room's colours are continued from so near [work px]
_NEVER = -1000  # differs from every picture


@dataclass(frozen=True, slots=True, eq=False)
class HiddenRoom:
    """colour (h,w,3): the guess 0..255, or _NEVER; tolerance: of a channel, 0..255."""

    colour: NDArray[np.int16]
    tolerance: float

    def is_seen(self, picture: Bytes) -> NDArray[np.bool_]:
        """(h,w): where a picture (h,w,3) looks like the room."""
        off = np.abs(picture - self.colour).max(axis=-1)
        return np.asarray(off <= self.tolerance, np.bool_)

    def where_hidden(self, picture: Bytes) -> "HiddenRoom":
        """The guess only where a picture (h,w,3) differs from it, so that clothes in the room's colours have no holes."""
        hides = ~self.is_seen(picture)
        return HiddenRoom(np.where(hides[..., None], self.colour, np.int16(_NEVER)), self.tolerance)


def guess_room(picture: Bytes, body: Bytes, tolerance: float) -> HiddenRoom:
    """Continue the room around a body into it. picture (h,w,3); body (h,w): not 0 on the body with a margin."""
    guess = cv2.inpaint(picture, body, _REACH_PX, cv2.INPAINT_TELEA)
    return HiddenRoom(guess.astype(np.int16), tolerance)
