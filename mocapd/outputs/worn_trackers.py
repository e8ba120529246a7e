"""Trackers as VR programs know them, strapped to a body: the number of each, and of which bones its place and rotation are.

The numbers are SlimeVR's ("don't change, as third party applications may rely on this", its VRCOSCHandler);
VRChat itself finds out at calibration what each tracker is on, SteamVR is told by the user. As SlimeVR's, a
tracker is at the end of the bone whose rotation it has: the knee's turns with the thigh, the elbow's with the upper
arm (its HumanSkeleton).
"""

from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

BodyPart = Literal["hip", "feet", "chest", "knees", "elbows"]


@dataclass(frozen=True, slots=True)
class WornTracker:
    """number: in VRChat's addresses; label: for people; place, turn: VRM names of the joint where it is, and of the
    bone whose rotation it has. It is as well known as the less known of the two."""

    number: int
    label: str
    place: str
    turn: str


TRACKERS_OF: MappingProxyType[BodyPart, tuple[WornTracker, ...]] = MappingProxyType(
    {
        "hip": (WornTracker(1, "hip", "hips", "hips"),),
        "feet": (
            WornTracker(2, "left foot", "leftFoot", "leftFoot"),
            WornTracker(3, "right foot", "rightFoot", "rightFoot"),
        ),
        "knees": (
            WornTracker(4, "left knee", "leftLowerLeg", "leftUpperLeg"),
            WornTracker(5, "right knee", "rightLowerLeg", "rightUpperLeg"),
        ),
        "chest": (WornTracker(6, "chest", "upperChest", "upperChest"),),
        "elbows": (
            WornTracker(7, "left elbow", "leftLowerArm", "leftUpperArm"),
            WornTracker(8, "right elbow", "rightLowerArm", "rightUpperArm"),
        ),
    }
)


def trackers_of(parts: tuple[BodyPart, ...]) -> tuple[WornTracker, ...]:
    """The trackers of these parts of the body, each once, by number."""
    found = {one.number: one for part in parts for one in TRACKERS_OF[part]}
    return tuple(found[number] for number in sorted(found))
