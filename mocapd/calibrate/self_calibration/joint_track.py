"""Tracks the wearer with all cameras together, in pictures that each camera classified alone.

A single camera has arms pointing the wrong way for seconds. With approximate extrinsics all cameras together resolve that;
a second solution from these poses is more accurate.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mocapd.body.model import BodyModel
from mocapd.calibrate.self_calibration.keyframes import Keyframe, initial_states, keyframe_views
from mocapd.calibrate.self_calibration.patch_tracks import PatchObservation, PatchSighting
from mocapd.clock import seconds
from mocapd.fit.fit_params import FitParams
from mocapd.fit.fit_result import Fit
from mocapd.fit.motion_state import MotionState, predict_state, step_between
from mocapd.fit.solver import Fitter
from mocapd.fit.work_size import image_scales
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import to_camera
from mocapd.shirt.garment import shirt_labels
from mocapd.types import Camera, Floats, Rig

_ITERATIONS = 6
_LOOSE_S = 0.4  # weight of a single camera's body, as of a prediction over this time
_LONGEST_GAP_S = 0.2  # of a prediction
_LEAST_MATCH = 0.6
_FASTEST = 8.0  # of a pose, m/s and rad/s
_DAMPING = 0.8


class _Follower:
    """Fits one observation after the other, starting from the last result."""

    def __init__(self, model: BodyModel, cameras: Sequence[Camera], factors: Floats) -> None:
        params = FitParams()
        self._scales = image_scales(cameras, params.work_width_px)
        self._fitter = Fitter(model, shirt_labels(model), cameras, self._scales, params)
        self._model, self._cameras, self._factors = model, cameras, factors
        self._last: tuple[int, MotionState] | None = None

    def follow(self, keyframe: Keyframe) -> Fit | None:
        """The body in one observation; None when the pictures do not confirm it."""
        views = keyframe_views(keyframe, self._scales)
        starts = initial_states(keyframe, self._cameras, self._model, self._factors)
        last, dt_s = self._before(keyframe.t_ns)
        if last is not None:
            starts = [replace(s, velocity=last.velocity) for s in starts]
        fits = [self._fitter.fit(s, views, _LOOSE_S, _ITERATIONS) for s in starts]
        if last is not None:
            ahead = predict_state(self._model, last, dt_s, _DAMPING)
            fits.append(self._fitter.fit(ahead, views, dt_s, _ITERATIONS))
        best = min(fits, key=lambda fit: fit.cost)
        self._last = None
        if best.match < _LEAST_MATCH:
            return None
        velocity = np.zeros(self._model.n_pose)
        if last is not None:
            now, before = ((s.root_m, s.local_xyzw) for s in (best.state, last))
            velocity = np.clip(step_between(self._model, now, before) / dt_s, -_FASTEST, _FASTEST)
        self._last = keyframe.t_ns, replace(best.state, velocity=velocity)
        return best

    def _before(self, t_ns: int) -> tuple[MotionState | None, float]:
        """The last state, and its age [s]."""
        if self._last is None:
            return None, 0.0
        dt_s = seconds(t_ns - self._last[0])
        return (self._last[1], dt_s) if 0.0 < dt_s < _LONGEST_GAP_S else (None, dt_s)

    def sighting(self, fit: Fit, own: PatchSighting, camera: Camera, dt_s: float) -> PatchSighting:
        """A camera's sighting with the common body, dt_s later."""
        joints, quats = self._fitter.joints(predict_state(self._model, fit.state, dt_s))
        turned = rotations.multiply(rotations.from_matrix(camera.R), quats)
        return replace(own, joints_m=to_camera(camera, joints), quats_xyzw=turned)


def followed_together(
    observations: Sequence[PatchObservation], rig: Rig, model: BodyModel, factors: Floats
) -> list[PatchObservation]:
    """The observations with the common body of all cameras, which has these proportions (n_shape,).

    Observations of a single camera, and those without agreement, become empty.
    """
    follower = _Follower(model, rig.cameras, factors)
    out: list[PatchObservation] = []
    for observation in observations:
        sightings = {i: observation[n] for i, n in enumerate(rig.names) if n in observation}
        together: dict[str, PatchSighting] = {}
        if len(sightings) >= 2:
            t_ns = sightings[min(sightings)].t_ns
            fit = follower.follow(Keyframe(t_ns, sightings, None))
            if fit is not None:
                sure = np.maximum.reduce([s.confidence for s in sightings.values()])
                for i, sighting in sightings.items():
                    camera = rig.cameras[i]
                    later_s = seconds(sighting.t_ns - t_ns)
                    mine = follower.sighting(fit, sighting, camera, later_s)
                    together[camera.name] = replace(mine, confidence=sure)
        out.append(together)
    return out
