"""Smooths a body: One-Euro on the root and on each bone's rotation, then forward kinematics.

Joint positions follow from the smoothed pose, so bones keep their exact lengths.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

from mocapd.body.skeleton import joint_positions
from mocapd.clock import nanoseconds, seconds
from mocapd.errors import ConfigError
from mocapd.pipeline.one_euro import OneEuroParams, RotationOneEuro, VectorOneEuro
from mocapd.types import BodyState, Pose, Skeleton, Tracking

REST_AFTER_S = 0.5  # a longer gap between bodies starts the filters afresh [s]


@dataclass(frozen=True, slots=True)
class SmoothingPreset:
    """The two filters of a preset: of the root's position and of the bones' global rotations; lag_s: for a swinging arm,
    as measured below [s]."""

    root: OneEuroParams
    bones: OneEuroParams
    lag_s: float


# Measured at 30 Hz by `pytest -s tests/pipeline/test_smoothing_table.py`, which keeps this true.
# Jitter left at rest: of white noise of 5 mm and 2 degrees. Lag: behind hips swaying 0.3 m at
# 0.5 Hz (peak 0.9 m/s), and behind an arm swinging 60 degrees at 1 Hz (peak 380 degrees/s).
#
# |            | hips         |       | bones        |       |
# | preset     | jitter left  | lag   | jitter left  | lag   | made for
# | off        | 100 %        |  0 ms | 100 %        |  0 ms | recording, filters of your own
# | responsive |  61 %        |  5 ms |  61 %        |  6 ms | fast games
# | balanced   |  49 %        |  9 ms |  50 %        | 10 ms | the default
# | smooth     |  35 %        | 19 ms |  35 %        | 22 ms | avatars on show, slow exercise
PRESETS: Mapping[str, SmoothingPreset | None] = MappingProxyType(
    {
        "off": None,
        "responsive": SmoothingPreset(OneEuroParams(1.0, 40.0), OneEuroParams(1.0, 6.0), 0.006),
        "balanced": SmoothingPreset(OneEuroParams(0.7, 20.0), OneEuroParams(0.7, 3.0), 0.010),
        "smooth": SmoothingPreset(OneEuroParams(0.5, 7.0), OneEuroParams(0.5, 1.0), 0.022),
    }
)


class Smoother:
    """Smooths the bodies of one person in order of time; `lost` and gaps in time reset it. Its lag adds to that of the
    tracker's own filter.

    `skeleton` may be replaced between steps, when the tracker has refined its proportions.
    """

    def __init__(self, preset: str, skeleton: Skeleton) -> None:
        """Raises ConfigError for an unknown preset."""
        if preset not in PRESETS:
            raise ConfigError(
                f"no preset {preset!r}", "smoothing.preset", f"one of: {', '.join(PRESETS)}"
            )
        self.skeleton = skeleton
        self._filters: tuple[VectorOneEuro, RotationOneEuro] | None = None
        self._lag_ns = 0
        chosen = PRESETS[preset]
        if chosen is not None:
            self._filters = VectorOneEuro(chosen.root), RotationOneEuro(chosen.bones)
            self._lag_ns = nanoseconds(chosen.lag_s)
        self._t_ns: int | None = None

    def reset(self) -> None:
        """The next body passes unfiltered."""
        self._t_ns = None

    def step(self, body: BodyState) -> BodyState:
        """The body with its pose and joints smoothed; everything else unchanged."""
        if self._filters is None:
            return body
        if body.tracking is Tracking.LOST or body.pose is None:
            self.reset()
            return body
        root, bones = self._filters
        gap_ns = None if self._t_ns is None else body.t_ns - self._t_ns
        if gap_ns is None or not 0 < gap_ns <= nanoseconds(REST_AFTER_S):
            root.reset()
            bones.reset()
            dt_s = REST_AFTER_S  # unused by filters that were reset
        else:
            dt_s = seconds(gap_ns)
        self._t_ns = body.t_ns
        pose = Pose(root.step(body.pose.root_m, dt_s), bones.step(body.pose.quats_xyzw, dt_s))
        joints_m = joint_positions(self.skeleton, pose)
        lag_ns = body.smoothing_lag_ns + self._lag_ns
        return replace(body, pose=pose, joints_m=joints_m, smoothing_lag_ns=lag_ns)
