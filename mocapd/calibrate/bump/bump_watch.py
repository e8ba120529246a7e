"""Whether a camera was bumped: the room has moved in its pictures, all of it as by one turn, and stays so.

The wearer's body cannot tell: with two cameras, all that a turn does within the plane of both views
is taken up by the body's place, and what a roll does too. The fixed points of the room are seen by
each camera alone, with or without somebody there. See docs/decisions/calibration.md.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from mocapd.calibrate.bump.landmarks import Landmarks, find_landmarks, measure_turn
from mocapd.clock import nanoseconds
from mocapd.geometry import rotations
from mocapd.types import Bytes, Camera, Floats


class Mounting(StrEnum):
    """`unknown`: too little of the room is seen; `steady`; `bumped`: calibrate the room again; `swapped`: with another
    camera, which `places_watch` tells."""

    UNKNOWN = "unknown"
    STEADY = "steady"
    BUMPED = "bumped"
    SWAPPED = "swapped"


@dataclass(frozen=True, slots=True)
class BumpParams:
    """When a turn counts."""

    least_turn_deg: float = 0.4  # 2 cm at 3 m; that of a camera at rest is measured to 0.1
    least_marks: int = 10  # that agree, to say anything
    least_share: float = 0.2  # and of the marks there were: somebody near hides most of the room
    lasting_s: float = 1.5  # who leans against the table and goes is no bump
    blind_s: float = 10.0  # without enough marks, what was said is no longer known
    renewed_s: float = 10.0  # how often marks in the present light are kept beside the first ones


@dataclass(frozen=True, slots=True, eq=False)
class _Anchor:
    """Marks, and how far the camera was turned when they were made (4,)."""

    marks: Landmarks
    turned_xyzw: Floats


@dataclass(slots=True, eq=False)
class _CameraMemory:
    """What is remembered of one camera. anchors: the first marks, and the latest while it was steady."""

    camera: Camera
    anchors: list[_Anchor] = field(default_factory=list)
    renewed_ns: int = 0
    seen_ns: int = 0  # when enough marks were seen last
    seems: Mounting = Mounting.UNKNOWN  # what is seen, and since when
    since_ns: int = 0
    told: bool = False  # the first marks have shown to be of the room
    turn_deg: float = 0.0
    mounting: Mounting = Mounting.UNKNOWN


class BumpWatch:
    """Shown a picture of each camera now and then, about once a second; tells how each is mounted.

    What is usual is what it sees first: make it anew when the room was calibrated anew.
    """

    def __init__(self, cameras: Sequence[Camera], params: BumpParams | None = None) -> None:
        self._p = params if params is not None else BumpParams()
        self._watched = {camera.name: _CameraMemory(camera) for camera in cameras}

    def mounting(self, camera: str) -> Mounting:
        """As last seen; `unknown` for a camera that is not watched."""
        return self._watched[camera].mounting if camera in self._watched else Mounting.UNKNOWN

    def turn_deg(self, camera: str) -> float:
        """By how much it is turned from where it was at first, as last seen."""
        return self._watched[camera].turn_deg

    def look(self, name: str, t_ns: int, pixels: Bytes) -> Mounting:
        """A picture (height,width,3) BGR of one camera, and when it was taken."""
        p, one = self._p, self._watched[name]
        turned = self._turned(one, pixels)
        if turned is None:
            blind = t_ns - one.seen_ns > nanoseconds(p.blind_s)
            if blind:
                one.mounting = one.seems = Mounting.UNKNOWN
            if not one.anchors or (blind and not one.told):
                self._begin(one, t_ns, pixels)
            return one.mounting
        one.seen_ns = t_ns
        one.turn_deg = float(np.degrees(np.linalg.norm(rotations.log(turned))))
        self._judge(one, t_ns)
        if one.mounting is one.seems is Mounting.STEADY:
            self._renew(one, t_ns, pixels, turned)
        return one.mounting

    def _turned(self, one: _CameraMemory, pixels: Bytes) -> Floats | None:
        """(4,) since the first picture, by the first marks of which enough are seen."""
        p = self._p
        for anchor in one.anchors:
            seen = measure_turn(anchor.marks, pixels, one.camera)
            if seen.agree >= max(p.least_marks, p.least_share * len(anchor.marks.places)):
                return rotations.multiply(rotations.exp(seen.turn_rad), anchor.turned_xyzw)
        return None

    def _judge(self, one: _CameraMemory, t_ns: int) -> None:
        """What is seen for long enough becomes the mounting."""
        limit_deg = self._p.least_turn_deg
        if one.mounting is Mounting.BUMPED:
            limit_deg *= 0.5
        seems = Mounting.BUMPED if one.turn_deg > limit_deg else Mounting.STEADY
        if seems is not one.seems:
            one.seems, one.since_ns = seems, t_ns
        if t_ns - one.since_ns >= nanoseconds(self._p.lasting_s):
            one.mounting, one.told = seems, True

    def _begin(self, one: _CameraMemory, t_ns: int, pixels: Bytes) -> None:
        """The first marks, once there are enough."""
        marks = find_landmarks(pixels, one.camera)
        if len(marks.places) >= 2 * self._p.least_marks:
            one.anchors = [_Anchor(marks, rotations.IDENTITY_XYZW)]
            one.seen_ns = one.renewed_ns = t_ns

    def _renew(self, one: _CameraMemory, t_ns: int, pixels: Bytes, turned: Floats) -> None:
        """Marks of now, for when the light has changed so much that the first ones are not found."""
        if t_ns - one.renewed_ns < nanoseconds(self._p.renewed_s):
            return
        one.renewed_ns = t_ns
        marks = find_landmarks(pixels, one.camera)
        if len(marks.places) >= 2 * self._p.least_marks:
            one.anchors = [one.anchors[0], _Anchor(marks, turned)]
