"""State of the tracked body: pose, velocity and shape estimate."""

from dataclasses import dataclass, replace

import numpy as np

from mocapd.body.model import BodyModel
from mocapd.body.pose_space import PoseSpace, full_body
from mocapd.body.posing_kernels import difference, retract
from mocapd.body.shape import BodyShape
from mocapd.body.skeleton import N_JOINTS
from mocapd.geometry import rotations
from mocapd.types import Floats


@dataclass(frozen=True, slots=True, eq=False)
class MotionState:
    """A pose in motion: root_m (3,), local_xyzw (J,4), velocity (n_pose,) per second, and the
    shape estimate: factors (n_shape,) with their information matrix (n_shape,n_shape)."""

    root_m: Floats
    local_xyzw: Floats
    velocity: Floats
    factors: Floats
    information: Floats


def initial_information(space: PoseSpace) -> Floats:
    """Prior information on the proportions, before any picture."""
    return np.diag(1.0 / space.factor_sd**2)


def shape_prior(shape: BodyShape, space: PoseSpace) -> tuple[Floats, Floats]:
    """The factors (n_shape,) of a space from a wearer's shape, and their information matrix; the mean body's where the
    shape has none."""
    n = min(space.n_shape, len(shape.factors))
    factors, information = np.ones(space.n_shape), initial_information(space)
    factors[:n] = shape.factors[:n]
    if shape.information is not None:
        information[:n, :n] = shape.information[:n, :n]
    return factors, information


def update_shape(
    shape: BodyShape, factors: Floats, information: Floats, taught_s: float
) -> BodyShape:
    """The shape with new estimates of its first factors."""
    if len(factors) == len(shape.factors):
        return replace(shape, factors=factors, information=information, taught_s=taught_s)
    n, all_factors = len(factors), shape.factors.copy()
    all_factors[:n] = factors
    joint = initial_information(full_body()) if shape.information is None else shape.information
    joint = joint.copy()
    joint[:n, :n] = information
    return BodyShape(shape.stature_m, all_factors, joint, taught_s)


def apply_step(
    model: BodyModel, root_m: Floats, local_xyzw: Floats, step: Floats
) -> tuple[Floats, Floats]:
    """root_m and local_xyzw after a step (n_pose,) of the pose parameters."""
    root, local = np.empty(3), np.empty((N_JOINTS, 4))
    retract(root_m, local_xyzw, step, model.group_of_joint, model.share_of_joint, root, local)
    return root, local


def predict_pose(model: BodyModel, state: MotionState, dt_s: float) -> tuple[Floats, Floats]:
    """root_m and local_xyzw after dt_s at the state's velocity."""
    return apply_step(model, state.root_m, state.local_xyzw, state.velocity * dt_s)


def predict_state(
    model: BodyModel,
    state: MotionState,
    dt_s: float,
    damping: float = 1.0,
    root_damping: float | None = None,
) -> MotionState:
    """The state after dt_s at a share of its velocity: `damping`, and of the root's `root_damping`, if given."""
    step = state.velocity * (dt_s * damping)
    if root_damping is not None:
        step[:3] = state.velocity[:3] * (dt_s * root_damping)
    root, local = apply_step(model, state.root_m, state.local_xyzw, step)
    return replace(state, root_m=root, local_xyzw=local)


def turned_about_vertical(state: MotionState, turn_rad: float) -> MotionState:
    """The same body, turned on the spot."""
    local = state.local_xyzw.copy()
    local[0] = rotations.multiply(rotations.exp(np.array([0.0, turn_rad, 0.0])), local[0])
    return replace(state, local_xyzw=rotations.canonical(local))


def step_between(model: BodyModel, a: tuple[Floats, Floats], b: tuple[Floats, Floats]) -> Floats:
    """The pose step (n_pose,) from pose b to pose a, each (root_m, local_xyzw)."""
    out = np.empty(model.n_pose)
    difference(a[0], a[1], b[0], b[1], model.joint_of_group, model.share_of_joint, out)
    return out
