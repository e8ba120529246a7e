"""The last minute of a live session, frame by frame. Pure: frames come in, sessions go out."""

from collections import deque
from dataclasses import dataclass

import numpy as np

from mocapd.outputs.wire import SkeletonFrame
from mocapd.types import Floats
from mocapd_analysis.session import Session
from mocapd_analysis.session_files import checked_session

LONGEST_S = 60.0
MOST_FRAMES = 8000  # a minute at 120 Hz, and then some


@dataclass(frozen=True, slots=True, eq=False)
class _Pose:
    at_s: float
    joints_m: Floats
    confidence: Floats


class LiveBuffer:
    """Keeps what came last; another skeleton starts it afresh, as it is another person or daemon."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.refused = (
            0  # frames that were no pose of a person: not finite, or not later than the one before
        )
        self._names: tuple[str, ...] = ()
        self._start_ns = 0
        self._poses: deque[_Pose] = deque(maxlen=MOST_FRAMES)

    def add(self, frame: SkeletonFrame) -> bool:
        """Take a frame; whether it has a person. A lost one is no pose, and leaves a gap."""
        if not frame.joints:
            return False
        names = tuple(frame.joints)
        if names != self._names:
            self._poses.clear()
            self._names, self._start_ns = names, frame.capture_monotonic_ns
        at_s = (frame.capture_monotonic_ns - self._start_ns) * 1e-9  # nobody sets this clock
        joints_m = np.array([joint.p for joint in frame.joints.values()], dtype=float)
        confidence = np.array([joint.c for joint in frame.joints.values()], dtype=float)
        is_later = not self._poses or at_s > self._poses[-1].at_s
        # the clock of a machine that was started anew starts the session afresh
        if not is_later and at_s < self._poses[-1].at_s - LONGEST_S:
            self._poses.clear()
            is_later = True
        if not (is_later and np.isfinite(joints_m).all() and np.isfinite(confidence).all()):
            self.refused += 1
            return False
        self._poses.append(_Pose(at_s, joints_m, confidence))
        while self._poses[-1].at_s - self._poses[0].at_s > LONGEST_S:
            self._poses.popleft()
        return True

    def session(self) -> Session | None:
        """What is kept, from time 0; None before anybody was seen. Raises InputError for no body of VRM's joints."""
        if not self._poses:
            return None
        poses = tuple(self._poses)
        return checked_session(
            self.name,
            self._names,
            np.array([pose.at_s for pose in poses]),
            np.stack([pose.joints_m for pose in poses]),
            np.stack([pose.confidence for pose in poses]),
        )
