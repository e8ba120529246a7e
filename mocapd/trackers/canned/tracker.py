"""The tutorial tracker: looks at no picture and replays a looping wave, for those who write clients."""

from dataclasses import dataclass

import numpy as np

from mocapd.body.skeleton import INDEX, global_from_local, joint_positions
from mocapd.clock import nanoseconds, seconds
from mocapd.errors import ConfigError
from mocapd.geometry import rotations
from mocapd.types import BodyState, FrameSet, Pose, Skeleton, Track, Tracking


@dataclass(frozen=True, slots=True)
class CannedParams:
    """loop_s: duration of one loop [s]; waves: how often the left hand waves in it.

    sway_m: how far the hips move to each side [m].
    """

    loop_s: float = 4.0
    waves: int = 6
    sway_m: float = 0.06

    def __post_init__(self) -> None:
        if not 0.1 <= self.loop_s <= 3600.0:
            raise ConfigError(f"{self.loop_s} s", "tracker.canned.loop_s", "give 0.1 to 3600")


class CannedTracker:
    """Live whenever there is a frame, whatever it shows: the pose is a pure function of its time."""

    name = "canned"

    def __init__(self, skeleton: Skeleton, params: CannedParams | None = None) -> None:
        self._skeleton = skeleton
        self._params = params if params is not None else CannedParams()

    @property
    def skeleton(self) -> Skeleton:
        """The one given: nothing is learned of the person."""
        return self._skeleton

    def reset(self) -> None:
        """Nothing to forget."""

    def step(self, frames: FrameSet) -> Track:
        """The loop's pose at `frames.t_ns`; lost without any frame."""
        n = len(self._skeleton.names)
        if not frames.frames:
            lost = BodyState(frames.t_ns, Tracking.LOST, self.name, None, None, np.zeros(n))
            return Track(lost)
        pose = canned_pose(self._skeleton, self._params, frames.t_ns)
        joints_m = joint_positions(self._skeleton, pose)
        cameras = tuple(frames.frames)
        return Track(
            BodyState(frames.t_ns, Tracking.LIVE, self.name, pose, joints_m, np.ones(n), cameras)
        )


def canned_pose(skeleton: Skeleton, params: CannedParams, t_ns: int) -> Pose:
    """The pose at a time: the left hand waves, the right arm swings, the hips sway and turn."""
    # the remainder first: a float has no digits left for days of nanoseconds
    phase_s = seconds(t_ns % nanoseconds(params.loop_s))
    loop = 2.0 * np.pi * phase_s / params.loop_s
    wave = params.waves * loop
    local = np.tile(rotations.IDENTITY_XYZW, (len(skeleton.names), 1))

    def turn(bone: str, x_deg: float = 0.0, y_deg: float = 0.0, z_deg: float = 0.0) -> None:
        local[INDEX[bone]] = rotations.exp(np.radians([x_deg, y_deg, z_deg]))

    # at rest a person faces +Z with the left arm along +X: -z lowers the left arm, +z the right
    turn("hips", y_deg=12.0 * np.sin(loop))
    turn("spine", z_deg=-4.0 * np.sin(loop))
    turn("head", y_deg=15.0 * np.sin(loop), x_deg=5.0 * np.sin(2.0 * loop))
    turn("leftUpperArm", z_deg=15.0)
    turn("leftLowerArm", z_deg=60.0 + 25.0 * np.sin(wave))
    turn("rightUpperArm", z_deg=70.0, y_deg=20.0 * np.sin(loop))
    turn("rightLowerArm", y_deg=25.0 - 15.0 * np.cos(loop))
    root_m = skeleton.rest_m[0] + np.array([params.sway_m * np.sin(loop), 0.0, 0.0])
    return Pose(root_m, global_from_local(skeleton, local))
