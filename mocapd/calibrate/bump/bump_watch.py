"""Detects a bumped camera: the whole room moved in its pictures as by one rotation, and stays so.

The wearer's body cannot show that: with two cameras, the body's position absorbs a rotation within the plane
of both views, and a roll, too. The room's fixed points show it in each camera alone, with or without a person in
view. See docs/decisions/calibration.md.
"""

from enum import StrEnum

import numpy as np

from mocapd.calibrate.bump.landmark_memory import LandmarkMemory
from mocapd.clock import nanoseconds
from mocapd.geometry import rotations
from mocapd.types import Bytes

_LEAST_TURN_DEG = 0.4  # of a bump: 2 cm at 3 m; that of a camera at rest is measured to 0.1
_LASTING_S = 1.5  # debounce: leaning against the table is no bump
_BLIND_S = 10.0  # without enough marks for so long, the mounting is unknown
_RENEWED_S = 10.0  # interval at which a view in the present light replaces the latest one


class Mounting(StrEnum):
    """`unknown`: too little of the room is visible; `steady`; `bumped`: calibrate the room again; `swapped`: with another
    camera, as `swapped_cameras` decides."""

    UNKNOWN = "unknown"
    STEADY = "steady"
    BUMPED = "bumped"
    SWAPPED = "swapped"


class BumpWatch:
    """Watches one camera; needs a picture about once a second.

    The first pictures define the camera's pose: make a new instance after calibrating the room again.
    """

    def __init__(self, memory: LandmarkMemory) -> None:
        self._memory = memory
        self._renewed_ns = 0
        self._recognised_ns = 0
        self._seems = Mounting.UNKNOWN  # in the latest picture, and since when
        self._since_ns = 0
        self._is_confirmed = False  # whether the first view has proved to be of the room
        self._is_blind = False
        self.mounting = Mounting.UNKNOWN
        self.turn_deg = 0.0  # from the first view to the latest recognised picture
        self.is_recognised = False  # the room, in the latest picture

    def look(self, t_ns: int, pixels: Bytes) -> Mounting:
        """Take a picture (height,width,3) BGR and its time."""
        turned = self._memory.turn(pixels)
        self.is_recognised = turned is not None
        if turned is None:
            self._look_unrecognised(t_ns, pixels)
            return self.mounting
        self._recognised_ns = t_ns
        self.turn_deg = float(np.degrees(np.linalg.norm(rotations.log(turned))))
        self._judge(t_ns)
        is_steady = self.mounting is self._seems is Mounting.STEADY
        if is_steady and t_ns - self._renewed_ns >= nanoseconds(_RENEWED_S):
            self._renewed_ns = t_ns
            self._memory.renew(pixels, turned)
        return self.mounting

    def remember_unrecognised(self, t_ns: int, pixels: Bytes) -> None:
        """Add a picture that is certainly this camera's to the memory, for the present light, after a long time without
        recognition."""
        if self._is_blind and t_ns - self._renewed_ns >= nanoseconds(_RENEWED_S):
            self._renewed_ns = t_ns
            self._memory.add_unrecognised(pixels)

    def _look_unrecognised(self, t_ns: int, pixels: Bytes) -> None:
        self._is_blind = t_ns - self._recognised_ns > nanoseconds(_BLIND_S)
        if self._is_blind:
            self.mounting = self._seems = Mounting.UNKNOWN
        if self._memory.has_begun and (self._is_confirmed or not self._is_blind):
            return
        if self._memory.begin(pixels):
            self._recognised_ns = self._renewed_ns = t_ns
            self.is_recognised = True

    def _judge(self, t_ns: int) -> None:
        """Debounce: a state that lasts long enough becomes the mounting."""
        limit_deg = _LEAST_TURN_DEG
        if self.mounting is Mounting.BUMPED:
            limit_deg *= 0.5
        seems = Mounting.BUMPED if self.turn_deg > limit_deg else Mounting.STEADY
        if seems is not self._seems:
            self._seems, self._since_ns = seems, t_ns
        if t_ns - self._since_ns >= nanoseconds(_LASTING_S):
            self.mounting, self._is_confirmed = seems, True
