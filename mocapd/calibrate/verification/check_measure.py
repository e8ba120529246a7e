"""A tracker wrapper that measures the distance of each camera's picture from the body."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from mocapd.body.model import build_model
from mocapd.body.pose_space import full_body
from mocapd.body.shape import BodyShape, mean_shape, skeleton_of
from mocapd.body.skeleton import INDEX, local_from_global
from mocapd.calibrate.self_calibration.body_rows import RowGatherer
from mocapd.clock import nanoseconds, seconds
from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import MotionState, initial_information, shape_prior, step_between
from mocapd.fit.solver import Fitter
from mocapd.fit.view import View
from mocapd.fit.work_size import image_scales
from mocapd.geometry.camera_model import to_camera
from mocapd.shirt.garment import shirt_labels
from mocapd.tracking.base import Track, Tracker
from mocapd.tracking.cues.clothes.regions import silhouette_labels
from mocapd.types import BodyState, Floats, FrameSet, Rig, Skeleton, Tracking

EVERY = 4  # frames between measurements
_RADIUS_PX = 12  # work px, search radius for a colour
_STEPS = 3  # Gauss-Newton; edges in place hold back the first
_OUTLINE_STEPS = 6  # of an outline, whose inside adds nothing
_RIDGE = 1e-3
_STALE_S = 0.2  # an older pose gives no velocity


@dataclass(frozen=True, slots=True, eq=False)
class CameraMeasure:
    """shift_px (2,): from the drawn body to the one in the picture, in pixels of the frame; shift_m: the same at the
    body's distance [m]; match: share of the drawn shirt with its colour in the picture."""

    shift_px: Floats
    shift_m: float
    match: float


@dataclass(frozen=True, slots=True, eq=False)
class Measure:
    """One frame with a tracked person. upright_rad: of hips to neck from the vertical; hips_m: height above the
    floor; lengths: shoulders, upper arm and forearm relative to a mean body of this stature, NaN by outline, which
    does not constrain them."""

    cameras: Mapping[str, CameraMeasure]
    upright_rad: float
    hips_m: float
    lengths: Floats


class MeasuringTracker:
    """Steps another tracker, and measures every fourth frame; implements Tracker.

    shape: the wearer's shape before any learning.
    """

    def __init__(
        self,
        tracker: Tracker,
        rig: Rig,
        shape: BodyShape,
        add: Callable[[Measure], None],
        by_outline: bool = False,
    ) -> None:
        """by_outline: compares the body as one region, not colour by colour."""
        self.name, self.probe = tracker.name, tracker.probe
        self._tracker, self._rig, self._add = tracker, rig, add
        stature_m = shape.stature_m
        self._mean = skeleton_of(mean_shape(stature_m))
        params = FitParams()
        self._work = image_scales(rig.cameras, params.work_width_px)
        self._by_outline = by_outline
        model = build_model(stature_m, full_body() if by_outline else None)
        labels = silhouette_labels(model) if by_outline else shirt_labels(model)
        self._fitter = Fitter(model, labels, rig.cameras, self._work, params)
        self._rows = RowGatherer(self._fitter, _RADIUS_PX)
        self._index = {camera.name: i for i, camera in enumerate(rig.cameras)}
        self._factors = shape_prior(shape, model.space)[0]
        self._last: tuple[int, Floats, Floats] | None = None
        self._turn = 0

    def reset(self, near: BodyState | None = None) -> None:
        self._tracker.reset(near)
        self._last = None

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        self._tracker.probe = self.probe
        track = self._tracker.step(frames, shape)
        body = track.body
        if body.tracking is Tracking.LIVE and body.pose is not None and track.evidence:
            local = local_from_global(self._mean, body.pose.quats_xyzw)
            self._turn += 1
            if self._turn % EVERY == 0:
                self._add(self._measure(body, local, track, frames))
            self._last = body.t_ns, body.pose.root_m, local
        return track

    def _measure(self, body: BodyState, local: Floats, track: Track, frames: FrameSet) -> Measure:
        assert body.pose is not None
        assert body.joints_m is not None
        factors, lengths = self._factors.copy(), np.full(3, np.nan)
        if not self._by_outline:
            lengths = _lengths(skeleton_of(track.shape)) / _lengths(self._mean)
            factors[1:4] = np.clip(lengths, 0.5, 2.0)
        model = self._fitter.model
        velocity = np.zeros(model.n_pose)
        if self._last is not None and 0 < body.t_ns - self._last[0] < nanoseconds(_STALE_S):
            dt_s = seconds(body.t_ns - self._last[0])
            velocity = step_between(model, (body.pose.root_m, local), self._last[1:]) / dt_s
        state = MotionState(
            body.pose.root_m, local, velocity, factors, initial_information(model.space)
        )
        spine = body.joints_m[INDEX["neck"]] - body.joints_m[INDEX["hips"]]
        return Measure(
            {name: self._camera(name, state, track, frames) for name in track.evidence},
            float(np.arccos(np.clip(spine[1] / np.linalg.norm(spine), -1.0, 1.0))),
            float(body.joints_m[INDEX["hips"], 1]),
            lengths,
        )

    def _camera(
        self, name: str, state: MotionState, track: Track, frames: FrameSet
    ) -> CameraMeasure:
        index = self._index[name]
        image_scale, camera = self._work[index], self._rig.cameras[index]
        x0, y0, x1, y1 = (edge // image_scale for edge in track.roi_px[name])
        ids = np.ascontiguousarray(track.evidence[name])
        if self._by_outline:
            ids = (ids > 0).astype(np.uint8)
        late_s = seconds(frames.frames[name].t_ns - frames.t_ns)
        view = View(index, (x0, y0, x1, y1), ids, np.zeros_like(ids), late_s)
        # an outline shows distance by its size only, which clothes change
        ways = camera.R[:2] if self._by_outline else np.eye(3)
        way_m, matches = np.zeros(3), []  # the shift of the whole body by this camera alone
        for _ in range(_OUTLINE_STEPS if self._by_outline else _STEPS):
            rows = self._rows.gather(replace(state, root_m=state.root_m + way_m), view)
            H = rows.H[:3, :3] + _RIDGE * np.eye(3)
            way_m = way_m + ways.T @ np.linalg.solve(ways @ H @ ways.T, ways @ rows.b[:3])
            matches.append(rows.match)
        depth_m = max(float(to_camera(camera, state.root_m)[2]), 0.2)
        across_m = (camera.R @ way_m)[:2]
        focal_px = np.array([camera.K[0, 0], camera.K[1, 1]])
        return CameraMeasure(
            focal_px * across_m / depth_m, float(np.linalg.norm(across_m)), matches[0]
        )


def _lengths(skeleton: Skeleton) -> Floats:
    """Width of the shoulders, length of an upper arm and a forearm [m]."""
    at_m = skeleton.rest_m
    arm, elbow, hand = (INDEX[f"left{bone}"] for bone in ("UpperArm", "LowerArm", "Hand"))
    return np.array(
        [
            abs(at_m[arm, 0]),
            np.linalg.norm(at_m[elbow] - at_m[arm]),
            np.linalg.norm(at_m[hand] - at_m[elbow]),
        ]
    )
