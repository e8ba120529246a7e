"""Standard deviations of the joint positions, from the information of one frame's pictures on the pose."""

from functools import cache

import numpy as np

from mocapd.body.model import BodyModel
from mocapd.body.pose_space import PoseSpace
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.fit.joint_uncertainty_kernels import (
    add_unmodelled_turns,
    joint_jacobian,
    place_variances,
)
from mocapd.fit.positive_inverse import positive_inverse
from mocapd.types import Floats

_NECK_SD_RAD = 0.3  # people nod and look about
# Of the evidence's information: measured against ground truth; pixel errors are correlated in time and between cameras
_WITNESSED = 0.5
_LEAST_M = 0.005  # floor: proportions, and the place of a joint in the flesh


def pose_covariance(model: BodyModel, H: Floats) -> Floats:
    """Of a pose step (n_pose,n_pose), from the information H (P,P) of one frame's evidence, the pose's first.

    Not the covariance that a fit begins its next prediction with, which counts earlier frames as
    independent: folds, proportions and lenses err alike in all of them, and a hidden arm gains no information from
    earlier predictions. Where a picture has no evidence any usual pose is possible.
    """
    n = model.n_pose
    information = _WITNESSED * H[:n, :n]
    information[np.diag_indices(n)] += _usual_information(model.space)
    return positive_inverse(information)


def joint_uncertainty_m(
    model: BodyModel, joints_m: Floats, global_xyzw: Floats, covariance: Floats
) -> Floats:
    """One standard deviation of each joint's place (J,) [m]: the root mean square over the world's axes.

    So the covariance of a joint has the trace of this squared times the identity, and the distance from its true
    place is sqrt(3) times this, root mean square. joints_m (J,3), global_xyzw (J,4): a posed body of the model;
    covariance (n_pose,n_pose): of its pose step. Joints below bones that the model's pose space does not move are
    inf, but for the head: the neck's range is limited.
    """
    jacobian = joint_jacobian_m(model, joints_m, global_xyzw)
    variances = np.empty(N_JOINTS)
    place_variances(jacobian, covariance, variances)
    add_unmodelled_turns(model.parents, model.group_of_joint, _turn_sd(), joints_m, variances)
    uncertainty_m: Floats = np.sqrt(np.maximum(variances, 0.0) / 3.0 + _LEAST_M**2)
    return uncertainty_m


def joint_jacobian_m(model: BodyModel, joints_m: Floats, global_xyzw: Floats) -> Floats:
    """Derivative (J,3,n_pose) of the joint centres by a pose step: metres per metre and per radian."""
    out = np.empty((N_JOINTS, 3, model.n_pose))
    joint_jacobian(
        model.parents, model.group_of_joint, model.share_of_joint, global_xyzw, joints_m, out
    )
    return out


@cache
def _usual_information(space: PoseSpace) -> Floats:
    """(n_pose,) of a person somewhere in the play area, in usual poses."""
    collar = (0.2, 0.2, 0.2)
    sd_rad = space.by_group(
        {"spine": (0.4, 0.4, 0.4), "leftShoulder": collar, "rightShoulder": collar}, 1.0
    )
    information: Floats = 1.0 / np.concatenate([np.ones(3), sd_rad]) ** 2
    return information


@cache
def _turn_sd() -> Floats:
    """(J,) of bones without parameters, about each axis [rad]."""
    sd = np.full(N_JOINTS, np.inf)
    sd[INDEX["neck"]] = _NECK_SD_RAD
    return sd
