"""What another tracker knows of the body: taken over as a whole, or its upper body held while legs and head are fitted."""

import numpy as np

from mocapd.body.model import BodyModel
from mocapd.body.pose_space import upper_body
from mocapd.body.regions import Region
from mocapd.body.skeleton import N_JOINTS, local_from_global
from mocapd.fit.fit_params import TICK_S
from mocapd.fit.motion_state import MotionState, moved
from mocapd.geometry import rotations
from mocapd.trackers.flex.memory import Proportions
from mocapd.trackers.flex.params import Params
from mocapd.types import Floats, Pose, Skeleton

TAKEN_OVER_S = 0.1  # another tracker's body is held as loosely as a prediction over this time
LEGS = (Region.LEG, Region.FOOT)  # regions that a guide does not know
_UPPER = np.flatnonzero(upper_body().group_of_joint >= 0)  # joints that a guide knows


def taken_over(
    model: BodyModel, skeleton: Skeleton, pose: Pose, wearer: Proportions
) -> MotionState:
    """Another tracker's body, at rest."""
    local = local_from_global(skeleton, pose.quats_xyzw)
    still = np.zeros(model.n_pose)
    return MotionState(pose.root_m.copy(), local, still, wearer.factors, wearer.information)


def standing_below(model: BodyModel, upper: Pose, wearer: Proportions) -> MotionState:
    """Somebody with this upper body whose legs hang straight down."""
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    still = np.zeros(model.n_pose)
    return MotionState(upper.root_m, local, still, wearer.factors, wearer.information)


def predicted_below(
    model: BodyModel,
    skeleton: Skeleton,
    params: Params,
    last: MotionState,
    dt_s: float,
    upper: Pose,
    wearer: Proportions,
) -> MotionState:
    """The upper body as the guide has it, legs and head where they have gone since the last state."""
    local = moved(model, last, dt_s, params.prediction_damping)[1]
    local[_UPPER] = local_from_global(skeleton, upper.quats_xyzw)[_UPPER]
    return MotionState(
        upper.root_m.copy(), local, last.velocity, wearer.factors, wearer.information
    )


def guided_information(params: Params, prediction_sd: Floats, dt_s: float) -> Floats:
    """Of the prediction (n_pose,n_pose): the guide's part is held, the others as loosely as usual, by their standard
    deviations (n_pose,) in a tick."""
    held = np.zeros(len(prediction_sd))
    held[:3] = params.guided_sd_m**-2
    held[3 : upper_body().n_pose] = params.guided_sd_rad**-2
    return np.diag(held + 1.0 / (prediction_sd**2 * max(dt_s / TICK_S, 0.5)))
