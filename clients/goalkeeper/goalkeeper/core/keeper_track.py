"""Where the keeper's points are at any time, from the poses that a stream brings now and then. Pure.

Between two poses they move in straight lines. After the newest one they go on as fast as they lately moved,
for AHEAD_S at most, which makes up for what cameras, tracker and bus take; then they wait.
"""

from collections import deque

from goalkeeper.core.limbs import LimbPose
from mocapd.types import Floats

AHEAD_S = 0.06
LOST_AFTER_S = 0.4  # without a pose, before the keeper counts as lost
_KEPT = 16  # poses: a quarter of a second at 60 Hz
_SPEED_OVER_S = 0.07  # poses that the speed is taken from


class KeeperTrack:
    """Fed with `add`, asked with `at`; times are of one clock [s]."""

    def __init__(self) -> None:
        self._poses: deque[tuple[float, LimbPose]] = deque(maxlen=_KEPT)

    def add(self, t_s: float, pose: LimbPose | None) -> None:
        """A pose as it was at t_s; None: nobody was seen. One that is not newer than the last is left out."""
        if pose is not None and (not self._poses or t_s > self._poses[-1][0]):
            self._poses.append((t_s, pose))

    def clear(self) -> None:
        """Forget everything: the clock jumped, or another stream follows."""
        self._poses.clear()

    def at(self, t_s: float) -> LimbPose | None:
        """The pose at t_s; None: lost."""
        if not self._poses or t_s - self._poses[-1][0] > LOST_AFTER_S:
            return None
        newest_s, newest = self._poses[-1]
        if t_s >= newest_s:
            on_s = min(t_s - newest_s, AHEAD_S)
            return LimbPose(newest.points_m + on_s * self._velocity_mps(), newest.known)
        later_s, later = newest_s, newest
        for earlier_s, earlier in list(self._poses)[-2::-1]:
            if earlier_s <= t_s:
                share = (t_s - earlier_s) / (later_s - earlier_s)
                points_m = earlier.points_m + share * (later.points_m - earlier.points_m)
                return LimbPose(points_m, earlier.known & later.known)
            later_s, later = earlier_s, earlier
        return later

    def _velocity_mps(self) -> Floats:
        """Of each point (P,3); a point that was not known all the while stands still."""
        newest_s, newest = self._poses[-1]
        before_s, before = newest_s, newest
        for t_s, pose in list(self._poses)[-2::-1]:
            if newest_s - t_s > LOST_AFTER_S / 2:
                break
            before_s, before = t_s, pose
            if newest_s - t_s >= _SPEED_OVER_S:
                break
        known = (newest.known & before.known)[:, None]
        moved: Floats = (newest.points_m - before.points_m) * known
        return moved / max(newest_s - before_s, 1e-3)
