"""Which number each tracker has, and of which bones its place and its rotation are.

The numbers are SlimeVR's ("don't change, as third party applications may rely on this", its VRCOSCHandler);
VRChat itself finds out at calibration what each tracker is on. As SlimeVR's, a tracker is at the end of the bone
whose rotation it has: the knee's turns with the thigh, the elbow's with the upper arm (its HumanSkeleton).
"""

from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

BodyPart = Literal["hip", "feet", "chest", "knees", "elbows"]


@dataclass(frozen=True, slots=True)
class VrchatTracker:
    """number: in the addresses; label: for people; place, turn: VRM names of the joint where it is, and of the
    bone whose rotation it has. It is as well known as the less known of the two."""

    number: int
    label: str
    place: str
    turn: str


TRACKERS_OF: MappingProxyType[BodyPart, tuple[VrchatTracker, ...]] = MappingProxyType(
    {
        "hip": (VrchatTracker(1, "hip", "hips", "hips"),),
        "feet": (
            VrchatTracker(2, "left foot", "leftFoot", "leftFoot"),
            VrchatTracker(3, "right foot", "rightFoot", "rightFoot"),
        ),
        "knees": (
            VrchatTracker(4, "left knee", "leftLowerLeg", "leftUpperLeg"),
            VrchatTracker(5, "right knee", "rightLowerLeg", "rightUpperLeg"),
        ),
        "chest": (VrchatTracker(6, "chest", "upperChest", "upperChest"),),
        "elbows": (
            VrchatTracker(7, "left elbow", "leftLowerArm", "leftUpperArm"),
            VrchatTracker(8, "right elbow", "rightLowerArm", "rightUpperArm"),
        ),
    }
)


def trackers_of(parts: tuple[BodyPart, ...]) -> tuple[VrchatTracker, ...]:
    """The trackers of these parts of the body, each once, by number."""
    found = {one.number: one for part in parts for one in TRACKERS_OF[part]}
    return tuple(found[number] for number in sorted(found))
