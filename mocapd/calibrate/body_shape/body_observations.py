"""Selects observations for measuring the wearer's shape, and decides when there are enough."""

from collections.abc import Sequence

import numpy as np

from mocapd.body.model import BodyModel
from mocapd.body.skeleton import INDEX
from mocapd.calibrate.body_shape.body_shape_fit import BodyObservation, observe_body
from mocapd.clock import nanoseconds
from mocapd.tracking.base import Track
from mocapd.types import BodyState, Bytes, Camera, Floats, FrameSet, Tracking

_SURE = 0.15  # mean confidence of the arms' joints in an observation that counts
# enough are so many seconds of observations with both elbows bent through _BEND_RAD, or _LONGEST_GOOD_S without bends
_GOOD_S = 4.5
_LONGEST_GOOD_S = 12.0
_EVERY_S = 0.15  # between observations
_BEND_RAD = 0.6
PATIENCE_S = 40.0  # timeout for the total time without good visibility of the wearer
_SIDES = [
    [INDEX[side + bone] for bone in ("UpperArm", "LowerArm", "Hand")] for side in ("left", "right")
]


class BodyObservations:
    """Takes a tracker's results, frame set by frame set. Stores the pictures of one observation, `pictured`: the last
    one with the largest number of cameras, as a camera's frame may come too late."""

    def __init__(
        self, model: BodyModel, cameras: Sequence[Camera], every_s: float = _EVERY_S
    ) -> None:
        self._model, self._cameras = model, tuple(cameras)
        self._every_s = every_s
        self.observations: list[BodyObservation] = []
        self.pictures: dict[str, Bytes] = {}
        self.pictured = 0
        self._last: BodyObservation | None = None
        self._bends: list[Floats] = []

    def add(self, track: Track, frames: FrameSet) -> bool:
        """Returns whether the body is well visible; only some such frames become observations."""
        body = track.body
        before, self._last = self._last, None
        if body.tracking is not Tracking.LIVE or body.confidence[_SIDES].mean() < _SURE:
            return False
        self._last = observe_body(track, frames, self._model, self._cameras, before)
        if self._last is None or before is None:
            return False  # just found: the pose has not converged, and its velocity is unknown
        due_ns = self.observations[-1].t_ns + nanoseconds(self._every_s) if self.observations else 0
        if self._last.t_ns >= due_ns:
            self.observations.append(self._last)
            self._bends.append(elbow_bends(body))
            if len(frames.frames) >= len(self.pictures):
                self.pictures = {name: frame.pixels for name, frame in frames.frames.items()}
                self.pictured = len(self.observations) - 1
        return True

    @property
    def good_s(self) -> float:
        """Total time of the observations [s]."""
        return len(self.observations) * self._every_s

    @property
    def bent(self) -> bool:
        """Whether both elbows bent enough to locate them."""
        return bool(self._bends) and bool((np.ptp(self._bends, axis=0) >= _BEND_RAD).all())

    @property
    def share(self) -> float:
        """Progress towards enough observations, 0..1."""
        wanted_s = _GOOD_S if self.bent else _LONGEST_GOOD_S
        return min(1.0, self.good_s / wanted_s)


def elbow_bends(body: BodyState) -> Floats:
    """Angles (2,) [rad] between upper arm and forearm, left and right; 0 for a straight arm."""
    assert body.joints_m is not None
    out = []
    for upper, lower, hand in _SIDES:
        a = body.joints_m[lower] - body.joints_m[upper]
        b = body.joints_m[hand] - body.joints_m[lower]
        cosine = a @ b / max(float(np.linalg.norm(a) * np.linalg.norm(b)), 1e-9)
        out.append(np.arccos(np.clip(cosine, -1.0, 1.0)))
    return np.array(out)
