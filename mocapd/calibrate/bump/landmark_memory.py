"""A camera's memory of its room as landmarks, for recognising the room and measuring the camera's rotation.

It has the first view and the latest one, each with the camera's rotation since the first. Views of earlier runs, and of
times without recognition (other light), have no rotation: they only identify the room in a picture.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from mocapd.calibrate.bump.landmarks import Landmarks, find_landmarks, measure_turn
from mocapd.geometry import rotations
from mocapd.types import Bytes, Camera, Floats

_LEAST_MARKS = 20  # of a view worth remembering
# Marks that agree, and their share. In the same room the share is 0.3 and more, also with a person in front; in another
# camera's pictures of it 0.06 at most (measured on the simulated rooms). A person nearby hides most of the room.
_LEAST_AGREE, _LEAST_SHARE = 10, 0.2
_TIMES = 2.0  # the share of another camera's room, over that of the own one


@dataclass(frozen=True, slots=True, eq=False)
class _TurnedView:
    """Marks, and the camera's rotation at that time (4,)."""

    marks: Landmarks
    turned_xyzw: Floats


class LandmarkMemory:
    """The memory of one camera; pictures are (height,width,3) BGR. For one thread."""

    def __init__(self, camera: Camera, earlier: Sequence[Landmarks] = ()) -> None:
        """earlier: views of earlier runs."""
        self.camera = camera
        self._turned: list[_TurnedView] = []
        self._other = list(earlier)

    @property
    def views(self) -> list[Landmarks]:
        """All views, the earliest first; at most four once this run has one of its own."""
        return [*self._other[:1], *(view.marks for view in self._turned), *self._other[1:]]

    @property
    def has_begun(self) -> bool:
        """Whether this run has a view of its own."""
        return bool(self._turned)

    def turn(self, pixels: Bytes) -> Floats | None:
        """(4,) xyzw from the first view to the picture, by the first recognised view; None without recognition."""
        for view in self._turned:
            turn = measure_turn(view.marks, pixels, self.camera)
            if turn.agree >= max(_LEAST_AGREE, _LEAST_SHARE * len(view.marks.places)):
                return rotations.multiply(rotations.exp(turn.turn_rad), view.turned_xyzw)
        return None

    def likeness(self, pixels: Bytes) -> float:
        """The largest share of a view's marks that the picture shows again; 0 for too few marks."""
        best = 0.0
        for marks in self.views:
            agree = measure_turn(marks, pixels, self.camera).agree
            if agree >= _LEAST_AGREE:
                best = max(best, agree / len(marks.places))
        return best

    def begin(self, pixels: Bytes) -> bool:
        """Take the picture as this run's first view; returns whether it shows enough."""
        marks = find_landmarks(pixels, self.camera)
        if len(marks.places) < _LEAST_MARKS:
            return False
        self._turned = [_TurnedView(marks, rotations.IDENTITY_XYZW)]
        self._other = self._other[:1]
        return True

    def renew(self, pixels: Bytes, turned_xyzw: Floats) -> None:
        """Take the picture as the latest view, in addition to the first: light changes."""
        marks = find_landmarks(pixels, self.camera)
        if len(marks.places) >= _LEAST_MARKS:
            self._turned = [self._turned[0], _TurnedView(marks, turned_xyzw)]

    def add_unrecognised(self, pixels: Bytes) -> None:
        """Remember a view that is certainly this camera's and differs from the others."""
        marks = find_landmarks(pixels, self.camera)
        if len(marks.places) >= _LEAST_MARKS:
            self._other = [*self._other[:1], marks]


def is_own_room(own: float, other: float) -> bool:
    """By the likeness to the camera's own room and the best one to another camera's."""
    return own >= _LEAST_SHARE and own > _TIMES * other


def is_other_room(own: float, other: float) -> bool:
    """Whether it is the other camera's room instead."""
    return is_own_room(other, own)
