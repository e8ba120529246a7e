"""A whole pose from keypoints of several pictures, without an assumption about the stance and without iteration.

First weighted linear triangulation of all joints together. Each camera also estimates each joint's depth relative to the
hips, so that cameras 12 cm apart, or one alone, suffice. Then the trunk from its four corners, and each limb by two-bone
IK (`fit/limbs/two_bone_ik.py`). A fit refines the result.
"""

from collections.abc import Sequence

import numpy as np

from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.fit.limbs.two_bone_ik import LIMBS, two_bone_pose
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.joint_term import JointRays
from mocapd.geometry import rotations
from mocapd.types import Floats

_HIPS = INDEX["hips"]
_SHOULDERS = [INDEX["leftUpperArm"], INDEX["rightUpperArm"]]
_HIP_JOINTS = [INDEX["leftUpperLeg"], INDEX["rightUpperLeg"]]


def triangulated_joints(
    detected: Sequence[JointRays], middle_m: Floats, middle_sd_m: float
) -> Floats:
    """Triangulated joints (J,3) [m, world]; NaN for joints that no camera detects.

    middle_m (3,): prior of the hips with standard deviation middle_sd_m. It decides only what the rays leave open, such as
    the distance from adjacent cameras.
    """
    joints = sorted({_HIPS, *(int(j) for one in detected for j in one.joints)})
    place = {j: k for k, j in enumerate(joints)}
    n = 3 * len(joints)
    H, b = np.zeros((n, n)), np.zeros(n)
    hips = slice(3 * place[_HIPS], 3 * place[_HIPS] + 3)
    H[hips, hips] += np.eye(3) / middle_sd_m**2
    b[hips] += middle_m / middle_sd_m**2
    for one in detected:
        R, t_m = one.camera.R, one.camera.t_m
        for (x, y), (xx, xy, yy), joint, farther_m, depth in zip(
            one.xy, one.information, one.joints, one.farther_m, one.depth_information, strict=True
        ):
            mine = slice(3 * place[joint], 3 * place[joint] + 3)
            # across the ray: (x z - X, y z - Y) = 0
            across = np.array([[-1.0, 0.0, x], [0.0, -1.0, y]])
            rows, W = across @ R, np.array([[xx, xy], [xy, yy]])
            H[mine, mine] += rows.T @ W @ rows
            b[mine] -= rows.T @ W @ (across @ t_m)
            if joint == _HIPS:
                continue
            along = depth * np.outer(R[2], R[2])
            H[mine, mine] += along
            H[hips, hips] += along
            H[mine, hips] -= along
            H[hips, mine] -= along
            b[mine] += depth * farther_m * R[2]
            b[hips] -= depth * farther_m * R[2]
    out = np.full((N_JOINTS, 3), np.nan)
    out[joints] = np.linalg.solve(H + 1e-6 * np.eye(n), b).reshape(-1, 3)
    return out


def pose_through(
    fitter: Fitter, places_m: Floats, factors: Floats, information: Floats
) -> MotionState | None:
    """A body of this shape with its joints about at places_m (J,3), NaN where unknown; None without all four trunk
    corners. Neck and head are as in the T-pose."""
    corners_m = places_m[[*_SHOULDERS, *_HIP_JOINTS]]
    if not np.isfinite(corners_m).all():
        return None
    up = corners_m[:2].mean(axis=0) - corners_m[2:].mean(axis=0)
    across = corners_m[0] - corners_m[1] + corners_m[2] - corners_m[3]
    trunk = _frame(across, up)
    if trunk is None:
        return None
    rest_m = fitter.shaper(factors).rest
    from_hips_m = rest_m[_HIP_JOINTS].mean(axis=0) - rest_m[_HIPS]
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    local[0] = rotations.from_matrix(trunk)
    root_m = corners_m[2:].mean(axis=0) - trunk @ from_hips_m
    state = MotionState(root_m, local, np.zeros(fitter.model.n_pose), factors, information)
    joints_m, globals_xyzw = fitter.joints(state)
    for limb in LIMBS.values():
        bent = two_bone_pose(limb, rest_m, joints_m, globals_xyzw, places_m)
        if bent is not None:
            local[[limb.upper, limb.lower]] = bent
    return MotionState(root_m, rotations.canonical(local), state.velocity, factors, information)


def _frame(across: Floats, up: Floats) -> Floats | None:
    """Rotation (3,3) of a trunk, with columns left, up the spine, forwards; None if `across` and `up` are nearly parallel."""
    z = np.cross(across, up)
    lengths = np.linalg.norm(across), np.linalg.norm(up), np.linalg.norm(z)
    if min(lengths) < 1e-3 or lengths[2] < 0.3 * lengths[0] * lengths[1]:
        return None
    y, z = up / lengths[1], z / lengths[2]
    return np.stack([np.cross(y, z), y, z], axis=-1)
