"""A body in motion as the colour tracker carries it from frame to frame."""

from dataclasses import dataclass

import numpy as np

from mocapd.body.model import BodyModel
from mocapd.body.pose_space import PoseSpace
from mocapd.body.posing_kernels import difference, retract
from mocapd.body.skeleton import N_JOINTS
from mocapd.types import Floats

# of measured proportions, as a part of the spread over all people
_MEASURED_SPREAD = 0.2


@dataclass(frozen=True, slots=True, eq=False)
class MotionState:
    """A pose in motion: root_m (3,), local_xyzw (J,4), velocity (n_pose,) per second, and what is
    known of the body: factors (n_shape,) with their information matrix (n_shape,n_shape)."""

    root_m: Floats
    local_xyzw: Floats
    velocity: Floats
    factors: Floats
    information: Floats


def initial_information(space: PoseSpace) -> Floats:
    """What is known of the proportions before anybody is seen."""
    return np.diag(1.0 / space.factor_sd**2)


def measured_information(space: PoseSpace) -> Floats:
    """What is known of proportions that `calibrate.body_shape_fit` has measured."""
    return np.diag(1.0 / (_MEASURED_SPREAD * space.factor_sd) ** 2)


def stepped(
    model: BodyModel, root_m: Floats, local_xyzw: Floats, step: Floats
) -> tuple[Floats, Floats]:
    """root_m and local_xyzw after a step (n_pose,) of the pose parameters."""
    root, local = np.empty(3), np.empty((N_JOINTS, 4))
    retract(root_m, local_xyzw, step, model.group_of_joint, model.share_of_joint, root, local)
    return root, local


def moved(
    model: BodyModel, state: MotionState, dt_s: float, damping: float = 1.0
) -> tuple[Floats, Floats]:
    """root_m and local_xyzw after dt_s at the state's velocity."""
    return stepped(model, state.root_m, state.local_xyzw, state.velocity * (dt_s * damping))


def step_between(model: BodyModel, a: tuple[Floats, Floats], b: tuple[Floats, Floats]) -> Floats:
    """The pose step (n_pose,) from pose b to pose a, each (root_m, local_xyzw)."""
    out = np.empty(model.n_pose)
    difference(a[0], a[1], b[0], b[1], model.joint_of_group, model.share_of_joint, out)
    return out
