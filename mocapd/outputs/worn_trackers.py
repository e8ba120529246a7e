"""Virtual trackers on a body, as for VR programs: the number, position joint and rotation bone of each.

The numbers are SlimeVR's ("don't change, as third party applications may rely on this", its VRCOSCHandler).
VRChat assigns trackers to body parts at calibration; in SteamVR the user does. As in SlimeVR (its HumanSkeleton), a
tracker is at the end of its rotation bone: the knee's rotates with the thigh, the elbow's with the upper arm.
"""

from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

BodyPart = Literal["hip", "feet", "chest", "knees", "elbows"]


@dataclass(frozen=True, slots=True)
class WornTracker:
    """number: in VRChat's addresses; label: for display; place, turn: VRM names of its position joint and of its
    rotation bone. Its confidence is the lower of the two."""

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
    trackers = {tracker.number: tracker for part in parts for tracker in TRACKERS_OF[part]}
    return tuple(trackers[number] for number in sorted(trackers))
