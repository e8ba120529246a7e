"""Selects observations of a recording for solving the extrinsics, and gives initial bodies for them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mocapd.body.model import BodyModel
from mocapd.body.skeleton import local_from_global, standard_skeleton
from mocapd.calibrate.self_calibration.body_rows import pictured
from mocapd.calibrate.self_calibration.patch_tracks import MARKS, PatchObservation, PatchSighting
from mocapd.clock import seconds
from mocapd.fit.motion_state import MotionState, initial_information, step_between
from mocapd.fit.view import View
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import from_camera
from mocapd.geometry.triangulation import triangulate
from mocapd.types import Camera, Floats

_LEAST_CONFIDENCE = 0.3
_AT_WORST = 0.1  # confidence, when fewer than half of the wanted number have the other one
_STILL_M_S = 0.3  # a mark that moves so fast halves an observation's worth


@dataclass(frozen=True, slots=True, eq=False)
class Keyframe:
    """An observation: its sightings by camera index, and the one of its first camera a frame earlier."""

    t_ns: int
    sightings: dict[int, PatchSighting]
    before: PatchSighting | None


def choose_keyframes(
    observations: Sequence[PatchObservation], names: Sequence[str], count: int
) -> list[Keyframe]:
    """Up to `count` observations by at least two cameras, spread over time, with high confidence and low speed."""
    chosen = _select(observations, names, count, _LEAST_CONFIDENCE)
    return chosen if len(chosen) >= count / 2 else _select(observations, names, count, _AT_WORST)


def _select(
    observations: Sequence[PatchObservation],
    names: Sequence[str],
    count: int,
    least_confidence: float,
) -> list[Keyframe]:
    rated: list[tuple[float, Keyframe]] = []
    last: dict[int, PatchSighting] = {}
    for observation in observations:
        sightings = {i: observation[name] for i, name in enumerate(names) if name in observation}
        if len(sightings) >= 2:
            first = min(sightings)
            worth = min(float(s.confidence[MARKS].mean()) for s in sightings.values())
            for i, sighting in sightings.items():
                if i in last:
                    dt_s = max(seconds(sighting.t_ns - last[i].t_ns), 1e-3)
                    way = sighting.joints_m[MARKS, :2] - last[i].joints_m[MARKS, :2]
                    speed = float(np.linalg.norm(way, axis=1).mean()) / dt_s
                    worth /= 1.0 + speed / _STILL_M_S
                else:
                    worth = 0.0  # just found: not converged
            if worth > 0.0 and all(
                s.confidence[MARKS].mean() > least_confidence for s in sightings.values()
            ):
                rated.append((worth, Keyframe(sightings[first].t_ns, sightings, last.get(first))))
        last = sightings
    if not rated:
        return []
    parts = np.array_split(np.arange(len(rated)), min(count, len(rated)))
    return [rated[max(part, key=lambda i: rated[i][0])][1] for part in parts]


def keyframe_views(keyframe: Keyframe, image_scales: Sequence[int]) -> list[View]:
    """Each camera's picture at its own instant."""
    return [
        pictured(i, s.ids, s.roi_px, image_scales[i], seconds(s.t_ns - keyframe.t_ns))
        for i, s in keyframe.sightings.items()
    ]


def initial_states(
    keyframe: Keyframe, cameras: Sequence[Camera], model: BodyModel, factors: Floats
) -> list[MotionState]:
    """The body of each camera alone, in the world, moved to its triangulated marks."""
    sightings = sorted(keyframe.sightings)
    xy = np.stack([keyframe.sightings[i].marks_xy for i in sightings])
    weights = np.stack([keyframe.sightings[i].confidence[MARKS] for i in sightings])
    points, _ = triangulate([cameras[i] for i in sightings], xy, weights)
    velocity = _velocity(keyframe, cameras[sightings[0]], model)
    out = []
    for i in sightings:
        sighting, camera = keyframe.sightings[i], cameras[i]
        joints = from_camera(camera, sighting.joints_m)
        offset = points - joints[MARKS]
        valid = np.isfinite(offset).all(axis=1)
        shift = np.median(offset[valid], axis=0) if valid.any() else np.zeros(3)
        out.append(
            MotionState(
                joints[0] + shift, _local(sighting, camera, model), velocity, factors.copy(),
                initial_information(model.space),
            )
        )  # fmt: skip
    return out


def _local(sighting: PatchSighting, camera: Camera, model: BodyModel) -> Floats:
    """Local rotations (J,4), the hips' in the world."""
    turned = rotations.multiply(rotations.from_matrix(camera.R.T), sighting.quats_xyzw)
    return local_from_global(standard_skeleton(model.stature_m), turned)


def _velocity(keyframe: Keyframe, camera: Camera, model: BodyModel) -> Floats:
    """Of the pose (n_pose,) per second, from the first camera."""
    now, before = keyframe.sightings[min(keyframe.sightings)], keyframe.before
    if before is None:
        return np.zeros(model.n_pose)
    dt_s = max(seconds(now.t_ns - before.t_ns), 1e-3)
    a, b = ((from_camera(camera, s.joints_m[0]), _local(s, camera, model)) for s in (now, before))
    return step_between(model, a, b) / dt_s
