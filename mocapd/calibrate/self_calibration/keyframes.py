"""Which observations of a recording are worth solving extrinsics from, and where a body starts in it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mocapd.body.model import BodyModel
from mocapd.body.skeleton import local_from_global, standard_skeleton
from mocapd.calibrate.self_calibration.patch_tracks import MARKS, PatchObservation, PatchSighting
from mocapd.clock import seconds
from mocapd.fit.motion_state import MotionState, initial_information, step_between
from mocapd.fit.view import View
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import from_camera
from mocapd.geometry.triangulation import triangulate
from mocapd.types import Camera, Floats

_PIXEL_WEIGHT = 255  # of unclassified pixels: less would let the body grow beyond its picture
_STILL_M_S = 0.3  # a mark that moves so fast halves an observation's worth


@dataclass(frozen=True, slots=True, eq=False)
class Keyframe:
    """An observation: its sightings by camera index, and the one of its first camera a frame earlier."""

    t_ns: int
    sightings: dict[int, PatchSighting]
    before: PatchSighting | None


def choose_keyframes(
    observations: Sequence[PatchObservation],
    names: Sequence[str],
    count: int,
    least_confidence: float = 0.3,
    at_worst: float = 0.1,
) -> list[Keyframe]:
    """Up to `count` observations seen by at least two cameras, spread over time, well seen and slow.

    at_worst: the confidence that does when fewer than half of `count` have the other.
    """
    chosen = _chosen(observations, names, count, least_confidence)
    if len(chosen) < count / 2 and at_worst < least_confidence:
        return _chosen(observations, names, count, at_worst)
    return chosen


def _chosen(
    observations: Sequence[PatchObservation],
    names: Sequence[str],
    count: int,
    least_confidence: float,
) -> list[Keyframe]:
    rated: list[tuple[float, Keyframe]] = []
    last: dict[int, PatchSighting] = {}
    for observation in observations:
        seen = {i: observation[name] for i, name in enumerate(names) if name in observation}
        if len(seen) >= 2:
            first = min(seen)
            worth = min(float(s.confidence[MARKS].mean()) for s in seen.values())
            for i, sighting in seen.items():
                if i in last:
                    dt_s = max(seconds(sighting.t_ns - last[i].t_ns), 1e-3)
                    way = sighting.joints_m[MARKS, :2] - last[i].joints_m[MARKS, :2]
                    speed = float(np.linalg.norm(way, axis=1).mean()) / dt_s
                    worth /= 1.0 + speed / _STILL_M_S
                else:
                    worth = 0.0  # just found: not settled
            if worth > 0.0 and all(
                s.confidence[MARKS].mean() > least_confidence for s in seen.values()
            ):
                rated.append((worth, Keyframe(seen[first].t_ns, seen, last.get(first))))
        last = seen
    if not rated:
        return []
    parts = np.array_split(np.arange(len(rated)), min(count, len(rated)))
    return [rated[max(part, key=lambda i: rated[i][0])][1] for part in parts]


def keyframe_views(keyframe: Keyframe, image_scales: Sequence[int]) -> list[View]:
    """What each camera saw, at its own instant."""
    out = []
    for i, s in keyframe.sightings.items():
        x0, y0, x1, y1 = (edge // image_scales[i] for edge in s.roi_px)
        pixel_weight = np.full(s.ids.shape, _PIXEL_WEIGHT, np.uint8)
        out.append(View(i, (x0, y0, x1, y1), s.ids, pixel_weight, seconds(s.t_ns - keyframe.t_ns)))
    return out


def initial_states(
    keyframe: Keyframe, cameras: Sequence[Camera], model: BodyModel, factors: Floats
) -> list[MotionState]:
    """The body as each camera alone saw it, in the world, moved to where all see its marks."""
    seen = sorted(keyframe.sightings)
    xy = np.stack([keyframe.sightings[i].marks_xy for i in seen])
    weights = np.stack([keyframe.sightings[i].confidence[MARKS] for i in seen])
    points, _ = triangulate([cameras[i] for i in seen], xy, weights)
    velocity = _velocity(keyframe, cameras[seen[0]], model)
    out = []
    for i in seen:
        sighting, camera = keyframe.sightings[i], cameras[i]
        joints = from_camera(camera, sighting.joints_m)
        offset = points - joints[MARKS]
        known = np.isfinite(offset).all(axis=1)
        shift = np.median(offset[known], axis=0) if known.any() else np.zeros(3)
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
    """Of the pose (n_pose,) per second, as the first camera saw it."""
    now, before = keyframe.sightings[min(keyframe.sightings)], keyframe.before
    if before is None:
        return np.zeros(model.n_pose)
    dt_s = max(seconds(now.t_ns - before.t_ns), 1e-3)
    a, b = ((from_camera(camera, s.joints_m[0]), _local(s, camera, model)) for s in (now, before))
    return step_between(model, a, b) / dt_s
