"""Limbs of a body that are far from their keypoints, and the pose in which they lie there."""

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from mocapd.fit.limbs.two_bone_ik import LIMBS, two_bone_pose
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.joint_term import JointTerm
from mocapd.geometry import rotations
from mocapd.tracking.cues.keypoints.keypoint_consensus import LEAST_CAMERAS
from mocapd.types import Floats

_KNOWN_SD_M = 0.15  # of a place where rays cross
_FAR_M = 0.12  # of a joint beside it


def limbs_off_crossings(keypoints: JointTerm, joints_m: Floats) -> list[str]:
    """The limbs of a body at joints_m (J,3) whose lower joint or end is far from where three rays or more cross."""
    if len(keypoints.rays) < LEAST_CAMERAS:  # of fewer, none can be told from the others
        return []
    crossing_m, sd_m = keypoints.crossings
    off_m = np.linalg.norm(crossing_m - joints_m, axis=1)
    is_off = (sd_m < _KNOWN_SD_M) & (off_m > _FAR_M)
    return [name for name, limb in LIMBS.items() if is_off[[limb.lower, limb.end]].any()]


def with_limbs_at_keypoints(
    fitter: Fitter, state: MotionState, keypoints: JointTerm, limbs: Collection[str]
) -> MotionState:
    """The body with these limbs laid through their keypoints, by two-bone IK: through the crossings of three rays or more,
    else as far away as the cameras say on average."""
    joints_m, globals_xyzw = fitter.joints(state)
    places_m = keypoints.places_m(joints_m[0])
    if len(keypoints.rays) >= LEAST_CAMERAS:
        crossing_m, sd_m = keypoints.crossings
        places_m = np.where((sd_m < _KNOWN_SD_M)[:, None], crossing_m, places_m)
    local = state.local_xyzw.copy()
    for name in limbs:
        limb = LIMBS[name]
        bent = two_bone_pose(limb, fitter.model.rest_m, joints_m, globals_xyzw, places_m)
        if bent is not None:
            local[[limb.upper, limb.lower]] = bent
    return replace(state, local_xyzw=rotations.canonical(local))
