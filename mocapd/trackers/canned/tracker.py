"""The tutorial tracker: ignores the pictures and replays a looping wave, for authors of clients."""

import numpy as np

from mocapd.body.shape import BodyShape, skeleton_of
from mocapd.body.skeleton import INDEX, global_from_local, joint_positions
from mocapd.clock import nanoseconds, seconds
from mocapd.geometry import rotations
from mocapd.trackers.canned.canned_motion import CannedMotion
from mocapd.tracking.base import Probe, Track, lost_body, no_probe
from mocapd.types import BodyState, FrameSet, Pose, Skeleton, Tracking

UNCERTAINTY_M = 0.01  # typical of a real tracker


class CannedTracker:
    """Live for every frame set with a frame: the pose is a pure function of time."""

    name = "canned"

    def __init__(self, motion: CannedMotion | None = None) -> None:
        self._motion = motion if motion is not None else CannedMotion()
        self.probe: Probe = no_probe

    def reset(self, near: BodyState | None = None) -> None:
        """Does nothing: the tracker has no state."""

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        """The loop's pose at `frames.t_ns`; lost without any frame."""
        if not frames.frames:
            return Track(lost_body(frames.t_ns, self.name), shape)
        skeleton = skeleton_of(shape)
        pose = canned_pose(skeleton, self._motion, frames.t_ns)
        joints_m = joint_positions(skeleton, pose)
        body = BodyState(
            frames.t_ns,
            Tracking.LIVE,
            self.name,
            pose,
            joints_m,
            np.ones(len(skeleton.names)),
            tuple(frames.frames),
            uncertainty_m=np.full(len(skeleton.names), UNCERTAINTY_M),
        )
        return Track(body, shape, quality=1.0)


def canned_pose(skeleton: Skeleton, motion: CannedMotion, t_ns: int) -> Pose:
    """The pose at a time: the left hand waves, the right arm swings, the hips sway and turn."""
    # the remainder first: a float is too coarse for days of nanoseconds
    phase_s = seconds(t_ns % nanoseconds(motion.loop_s))
    loop = 2.0 * np.pi * phase_s / motion.loop_s
    wave = motion.waves * loop
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
    root_m = skeleton.rest_m[0] + np.array([motion.sway_m * np.sin(loop), 0.0, 0.0])
    return Pose(root_m, global_from_local(skeleton, local))
