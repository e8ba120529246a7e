"""The pose that is told of a body in motion: where it has gone since it was seen, and how far each joint may be off."""

from dataclasses import dataclass, replace

import numpy as np

from mocapd.fit.joint_uncertainty import joint_uncertainty_m, pose_covariance
from mocapd.fit.motion_state import MotionState, gone_on
from mocapd.fit.solver import Fit, Fitter
from mocapd.trackers.blending import Residual, blended
from mocapd.types import Floats, Pose

_GOES_ON_S = 0.1  # without evidence it moves on for this long, then stays


@dataclass(frozen=True, slots=True, eq=False)
class ToldPose:
    """pose and joints_m (J,3); uncertainty_m (J,): one standard deviation of each place when it was last seen."""

    pose: Pose
    joints_m: Floats
    uncertainty_m: Floats


def told_pose(
    fitter: Fitter,
    state: MotionState,
    fit: Fit,
    left: Residual | None,
    away_s: float,
    damping: float,
) -> ToldPose:
    """Of a state that was fitted away_s [s] ago; left: of what was shown wrongly before; damping: of its motion."""
    if away_s > 0.0:
        state = gone_on(fitter.model, state, min(away_s, _GOES_ON_S), damping)
    if left is not None:
        root, local = blended(state.root_m, state.local_xyzw, left)
        state = replace(state, root_m=root, local_xyzw=local)
    joints, globals_ = fitter.joints(state)
    covariance = pose_covariance(fitter.model, fit.H)
    return ToldPose(
        Pose(joints[0], np.where(globals_[:, 3:] < 0, -globals_, globals_)),
        joints,
        joint_uncertainty_m(fitter.model, joints, globals_, covariance),
    )
