"""The body's surface of a shape: with rough legs, or whole.

Torso, arms with hands, neck with head, and legs are closed tubes that overlap. The surface depends
linearly on the shape factors, so its derivatives are differences taken once.
"""

from collections.abc import Callable

import numpy as np

from mocapd.body.arm_tubes import arm_tube
from mocapd.body.leg_tubes import foot_tube, leg_tube, plain_leg_tube
from mocapd.body.shape import N_FACTORS, BodyShape, skeleton_of
from mocapd.body.surface import Surface, Tube, join_tubes, tube_points
from mocapd.body.trunk_tubes import head_tube, torso_tube
from mocapd.types import Floats, Skeleton

MakeTubes = Callable[[BodyShape], list[Tube]]


def rough_tubes(shape: BodyShape) -> list[Tube]:
    """The tubes of a body in its T-pose, with rough legs."""
    skeleton = skeleton_of(shape)
    return [
        *_above_the_hips(shape, skeleton),
        plain_leg_tube(shape, skeleton, "left"),
        plain_leg_tube(shape, skeleton, "right"),
    ]


def whole_tubes(shape: BodyShape) -> list[Tube]:
    """The same with legs and feet that are tracked, too; above the hips it is vertex by vertex the same."""
    skeleton = skeleton_of(shape)
    return [
        *_above_the_hips(shape, skeleton),
        leg_tube(shape, skeleton, "left"),
        leg_tube(shape, skeleton, "right"),
        foot_tube(shape, skeleton, "left"),
        foot_tube(shape, skeleton, "right"),
    ]


def build_surface(shape: BodyShape) -> Surface:
    """The body of this shape in its T-pose; its legs are rough."""
    return join_tubes(rough_tubes(shape))


def build_whole_surface(shape: BodyShape) -> Surface:
    """The body of this shape in its T-pose, see `whole_tubes`."""
    return join_tubes(whole_tubes(shape))


def _above_the_hips(shape: BodyShape, skeleton: Skeleton) -> list[Tube]:
    """Torso, arms with hands, neck with head."""
    return [
        torso_tube(shape, skeleton),
        arm_tube(shape, skeleton, "left"),
        arm_tube(shape, skeleton, "right"),
        head_tube(shape, skeleton),
    ]


def shape_derivatives(
    stature_m: float, make_tubes: MakeTubes = rough_tubes, n_factors: int = N_FACTORS
) -> tuple[Floats, Floats]:
    """d vertices / d factor (N,V,3) and d rest joints / d factor (N,J,3) at the mean shape [m]."""
    step = 0.02
    dv, dj = [], []
    for i in range(n_factors):
        ends = []
        for sign in (-1.0, 1.0):
            factors = np.ones(n_factors)
            factors[i] += sign * step
            shape = BodyShape(stature_m, factors)
            points = np.concatenate([tube_points(tube) for tube in make_tubes(shape)])
            ends.append((points, skeleton_of(shape).rest_m))
        dv.append((ends[1][0] - ends[0][0]) / (2 * step))
        dj.append((ends[1][1] - ends[0][1]) / (2 * step))
    return np.array(dv), np.array(dj)
