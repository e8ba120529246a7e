"""Arm poses by two-bone IK, with the hand at an object in front of the rest of the body.

Few random poses come near a hand that is stretched out to the cameras. Stereo depth gives its place, and the elbow lies
on a circle.
"""

from collections.abc import Sequence

import numpy as np

from mocapd.body.skeleton import PARENTS
from mocapd.fit.limbs.arm_samples import Arm
from mocapd.fit.limbs.reaching_kernels import bend_to, rotations_of_bends
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.stereo_depth import GRID_PX, grid_rays
from mocapd.fit.view import View
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import centre
from mocapd.types import Floats

# Of the elbow about the line from shoulder to hand, from below it outwards
_SWIVELS_RAD = np.radians([0.0, 50.0, 100.0, -50.0])
_SKIN_M = 0.03  # a hand's middle is behind its skin
_IN_FRONT_M = 0.12  # least distance from the rest of the body
_FOLDED = 0.3  # of an arm's length: least distance of the hand from the shoulder
_STRETCHED = 1.05


def hand_target_poses(
    fitter: Fitter, state: MotionState, arm: Arm, views: Sequence[View], hands: int, turn: int
) -> Floats:
    """Local rotations (N,3,4) of collar, upper arm and forearm, of some hands and four elbows each; none
    without stereo depth. turn: a running number that selects other hands."""
    present = state.local_xyzw[arm.chain[:3]]
    view = next((view for view in views if view.depth_m is not None), None)
    if view is None:
        return np.empty((0, 3, 4))
    joints, globals_ = fitter.joints(state)
    hands_m = _points_in_front(fitter, state, arm, view, joints)
    step = max(len(hands_m) // hands, 1)
    hands_m = hands_m[turn % step :: step][:hands]
    return hand_poses(hands_m, joints, globals_, arm, present)


def _points_in_front(
    fitter: Fitter, state: MotionState, arm: Arm, view: View, joints_m: Floats
) -> Floats:
    """Points (N,3) in the arm's reach in front of the rest of the body."""
    assert view.depth_m is not None
    drawing = fitter.drawings[view.index]
    base = drawing.render_parts(state, view.dt_s, view.roi, arm.others)
    depth_m = view.depth_m[::GRID_PX, ::GRID_PX]
    y, x = np.nonzero(depth_m < base.zbuffer[::GRID_PX, ::GRID_PX] - _IN_FRONT_M)
    if not len(y):
        return np.empty((0, 3))
    origin = centre(drawing.camera)
    _, along = grid_rays(drawing.camera, drawing.image_scale, view.roi, y, x)
    z_m = depth_m[y, x] + _SKIN_M
    points: Floats = origin + along * (z_m / (along @ drawing.camera.R[2]))[:, None]
    shoulder, elbow, hand = joints_m[arm.chain[1:4]]
    length_m = np.linalg.norm(elbow - shoulder) + np.linalg.norm(hand - elbow)
    away_m = np.linalg.norm(points - shoulder, axis=1)
    near: Floats = points[(away_m > _FOLDED * length_m) & (away_m < _STRETCHED * length_m)]
    return near


def hand_poses(
    hands_m: Floats, joints_m: Floats, globals_xyzw: Floats, arm: Arm, present_xyzw: Floats
) -> Floats:
    """Local rotations (N,3,4) that bring the hand's joint of an arm to each of hands_m (T,3), or as near as it reaches.

    joints_m (J,3), globals_xyzw (J,4): of the body; present_xyzw (3,4): the arm's own, of which the collar stays. The
    forearm bends about its hinge, in the plane of shoulder, elbow and hand.
    """
    upper, lower = limb_bones_to(hands_m, joints_m, globals_xyzw, arm)
    return bones_to_rotations(
        upper.reshape(-1, 3), lower.reshape(-1, 3), joints_m, globals_xyzw, arm, present_xyzw
    )


def limb_bones_to(
    hands_m: Floats, joints_m: Floats, globals_xyzw: Floats, arm: Arm
) -> tuple[Floats, Floats]:
    """Upper arms and forearms (S,T,3 each) [m] that bring the hand to each of hands_m (T,3), or as near as it reaches, for
    each of S ways that the elbow is swivelled; others as `hand_poses`."""
    shoulder, elbow, hand = joints_m[arm.chain[1:4]]
    trunk = rotations.to_matrix(globals_xyzw[PARENTS[arm.chain[0]]])
    upper, lower = np.empty((2, len(_SWIVELS_RAD), len(hands_m), 3))
    bend_to(
        np.ascontiguousarray(hands_m), shoulder, float(np.linalg.norm(elbow - shoulder)), float(np.linalg.norm(hand - elbow)),
        _outwards(arm) * trunk[:, 0], _SWIVELS_RAD, upper, lower,
    )  # fmt: skip
    return upper, lower


def bones_to_rotations(
    upper: Floats,
    lower: Floats,
    joints_m: Floats,
    globals_xyzw: Floats,
    arm: Arm,
    present_xyzw: Floats,
) -> Floats:
    """Local rotations (T,3,4) of an arm with these upper arms and forearms (T,3 each) [m]; others as `hand_poses`."""
    collar = rotations.multiply(globals_xyzw[PARENTS[arm.chain[0]]], present_xyzw[0])
    shoulder, elbow = joints_m[arm.chain[1:3]]
    pose = np.repeat(present_xyzw[None], len(upper), axis=0)
    rotations_of_bends(
        upper, lower, _outwards(arm), float(np.linalg.norm(elbow - shoulder)), collar, pose
    )
    return pose


def _outwards(arm: Arm) -> float:
    """Of the body's own x, along which an arm lies in the T-pose."""
    return 1.0 if arm.side == "left" else -1.0
