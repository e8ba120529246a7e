"""Builds the published track: filtered pose, confidence and uncertainty of each joint, names of the carrying cues."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mocapd.body.bones import NAMES
from mocapd.body.pose_space import full_body
from mocapd.body.shape import BodyShape, skeleton_of
from mocapd.body.skeleton import INDEX, N_JOINTS, joint_positions
from mocapd.clock import nanoseconds, seconds
from mocapd.fit.fit_result import Fit
from mocapd.fit.joint_uncertainty import joint_uncertainty_m, pose_covariance
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.geometry import rotations
from mocapd.tracking.base import Track
from mocapd.tracking.bone_gains import Carrier
from mocapd.tracking.cues.clothes.clothes_cue import ClothesCue
from mocapd.tracking.cues.clothes.clothes_solver import ClothesEstimate
from mocapd.tracking.cues.shirt.shirt_cue import ShirtCue, ShirtEstimate
from mocapd.tracking.hypotheses.base import WHOLE
from mocapd.tracking.joint_confidence import (
    clothes_confidence,
    keypoint_agreement,
    shirt_confidence,
)
from mocapd.tracking.pose_filter import PoseFilter
from mocapd.tracking.track_state import TrackState, upper_body_state
from mocapd.tracking.tracking_state import confidence_fade, grow_uncertainty
from mocapd.tracking.trunk_and_legs import LOWER_BONES
from mocapd.types import BodyState, Floats, Pose, Tracking

_LOWER_JOINTS = np.setdiff1d(LOWER_BONES, [INDEX["neck"]])  # the shirt covers the neck
_IS_LOWER = np.isin(np.arange(N_JOINTS), _LOWER_JOINTS)


@dataclass(frozen=True, slots=True, eq=False)
class CueEstimates:
    """Each cue's estimate of the body in one frame set."""

    shirt: ShirtEstimate | None = None
    clothes: ClothesEstimate | None = None


def publish_body(
    state: TrackState,
    motion: MotionState,
    estimates: CueEstimates,
    shirt: ShirtCue | None,
    clothes: ClothesCue | None,
    pose_filter: PoseFilter,
    t_ns: int,
    tracking: Tracking,
    shape: BodyShape,
) -> Track:
    """The track at t_ns. motion: the body of `state`, extrapolated to t_ns."""
    away_s = seconds(t_ns - state.t_ns)
    away_of_joints_s = np.full(N_JOINTS, away_s)
    confidence, uncertainty_m = np.zeros(N_JOINTS), np.full(N_JOINTS, np.inf)
    agreement, unfiltered, from_one_side = np.ones(N_JOINTS), None, False
    if state.whole is not None and clothes is not None:
        unfiltered, uncertainty_m = _pose_with_uncertainty(clothes.fitter, motion, state.whole)
        away_of_whole_s = seconds(t_ns - state.whole_ns)
        n = len(state.cameras)
        confidence = clothes_confidence(state.whole, n, uncertainty_m, away_of_whole_s)
        agreement = keypoint_agreement(state.off_keypoints_m)
    if state.by_shirt and state.trunk is not None and shirt is not None:
        upper = upper_body_state(motion, shirt.model)
        by_trunk, of_trunk_m = _pose_with_uncertainty(shirt.fitter, upper, state.trunk)
        unfiltered = by_trunk if unfiltered is None else unfiltered
        by_it = shirt_confidence(state.trunk, len(state.cameras), of_trunk_m, away_s)
        lower = _LOWER_JOINTS if state.whole is not None else np.empty(0, np.int64)
        by_it[lower], of_trunk_m[lower] = confidence[lower], uncertainty_m[lower]
        away_of_joints_s[lower] = seconds(t_ns - state.whole_ns)
        confidence, uncertainty_m = by_it, of_trunk_m
        agreement = np.where(_IS_LOWER, agreement, 1.0)
        drawings = shirt.fitter.drawings
        showing = [i for i, one in enumerate(drawings) if one.camera.name in state.cameras]
        from_one_side = shirt.fitter.look_from_one_side(upper, showing)
    assert unfiltered is not None
    carrier = _carrier(state)
    jumped = _doubtful_bones(state, motion, estimates, clothes) if away_s == 0.0 else ()
    skeleton = skeleton_of(shape)
    by = Carrier(carrier, state.by_shirt, len(state.cameras), from_one_side)
    pose = pose_filter.step(unfiltered, confidence, t_ns, by, skeleton, jumped, state.legs_since_ns)
    joints_m = joint_positions(skeleton, pose)
    unfiltered_m = joint_positions(skeleton, unfiltered)
    behind_m = np.linalg.norm(joints_m - unfiltered_m, axis=1) / np.sqrt(3.0)
    body = BodyState(
        t_ns=t_ns,
        tracking=tracking,
        tracker=carrier,
        pose=pose,
        joints_m=joints_m,
        confidence=confidence * agreement,
        cameras=state.cameras if away_s == 0.0 else (),
        smoothing_lag_ns=nanoseconds(pose_filter.lag_s),
        uncertainty_m=np.hypot(grow_uncertainty(uncertainty_m, away_of_joints_s), behind_m),
    )
    carried_by = state.trunk if state.by_shirt else state.whole
    assert carried_by is not None
    quality = carried_by.explained * confidence_fade(away_s)
    if state.by_shirt and estimates.shirt is not None and shirt is not None:
        return Track(body, shape, quality, *shirt.evidence(estimates.shirt.views))
    if estimates.clothes is not None and clothes is not None:
        return Track(body, shape, quality, *clothes.cameras.evidence(list(estimates.clothes.views)))
    return Track(body, shape, quality)


def _pose_with_uncertainty(fitter: Fitter, motion: MotionState, fit: Fit) -> tuple[Pose, Floats]:
    """The pose, and one standard deviation of each joint's position (J,) [m]."""
    joints_m, globals_xyzw = fitter.joints(motion)
    uncertainty_m = joint_uncertainty_m(
        fitter.model, joints_m, globals_xyzw, pose_covariance(fitter.model, fit.H)
    )
    return Pose(joints_m[0], rotations.canonical(globals_xyzw)), uncertainty_m


def _carrier(state: TrackState) -> str:
    """Names of the cues that carry the body."""
    cues = [
        name
        for name, carries in (("shirt", state.by_shirt), ("clothes", state.whole is not None))
        if carries
    ]
    return "+".join(cues)


def _doubtful_bones(
    state: TrackState, motion: MotionState, estimates: CueEstimates, clothes: ClothesCue | None
) -> tuple[int, ...]:
    """Bones found elsewhere that may be elsewhere still: not where the views of clothes cross, which hide no depth."""
    found = estimates.clothes
    if clothes is None or found is None or state.by_shirt:
        return _bones(state.changed)
    small = clothes.fitter.has_small_baseline(motion, found.views)
    return _bones(state.changed) if small else ()


def _bones(parts: Sequence[str]) -> tuple[int, ...]:
    if WHOLE in parts:
        return tuple(range(len(NAMES)))
    return tuple(INDEX[bone] for part in parts for bone in full_body().parts[part].joints)
