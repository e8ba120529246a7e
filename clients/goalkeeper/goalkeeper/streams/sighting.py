"""What every stream of poses gives, and what it is: poses with the time they are of."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

from goalkeeper.core.limbs import LimbPose, pose_of_joints
from mocapd.outputs.wire import SkeletonFrame


@dataclass(frozen=True, slots=True)
class Sighting:
    """captured_s: middle of the exposure, on the clock that `poll` is asked with [s]; pose: None while lost."""

    captured_s: float
    pose: LimbPose | None


@dataclass(frozen=True, slots=True)
class StreamState:
    """trouble: one line for the player, empty when all is well; ended: nothing comes any more; slow: why the poses are too
    few, and what helps."""

    trouble: str = ""
    ended: bool = False
    slow: str = ""


class PoseStream(Protocol):
    """Asked once a picture; never waits."""

    def poll(self, now_s: float) -> list[Sighting]:
        """What is new at now_s, oldest first."""

    def state(self) -> StreamState:
        """How the stream fares."""

    def close(self) -> None:
        """Let go of everything; may be called twice."""


def pose_of_frame(frame: SkeletonFrame) -> LimbPose | None:
    """The keeper's pose of one published frame; None: nobody, or numbers that are no pose."""
    joints: Mapping[str, tuple[float, float, float]] = {
        name: joint.p for name, joint in frame.joints.items()
    }
    return pose_of_joints(joints)
