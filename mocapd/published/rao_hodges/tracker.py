"""The published tracker with the visual hull: limbs of ellipsoids in an annealed particle filter.

Rao and Hodges, Interactive marker-less tracking of human limbs (manuscript for IEEE Transactions on Visualization and
Computer Graphics).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from mocapd.body.shape import BodyShape, mean_shape, skeleton_of
from mocapd.body.skeleton import joint_positions
from mocapd.clock import nanoseconds, seconds
from mocapd.geometry.camera_model import common_place
from mocapd.published.rao_hodges.body_chains import (
    BodyChains,
    BodyPlace,
    body_chains,
    by_joint,
    place_of,
    pose_of,
)
from mocapd.published.rao_hodges.body_search import (
    follow_body,
    match_body,
    start_body,
    upright_place,
)
from mocapd.published.rao_hodges.limb_weight import places_within, pose_limb
from mocapd.published.rao_hodges.params import Params
from mocapd.published.rao_hodges.point_cloud import PointCloud, point_cloud
from mocapd.published.rao_hodges.silhouettes import RigSilhouettes
from mocapd.tracking.base import Probe, Track, lost_body, no_probe, require_stature
from mocapd.tracking.tracking_state import (
    TrackingState,
    TrackingStateParams,
    confidence_fade,
    grow_uncertainty,
)
from mocapd.types import BodyState, Bytes, Floats, FrameSet, Rig, Tracking
from mocapd.vision.hull.ray_hull import HullPoints, RayHullParams, box_about, hull_points, views_of

_TICK_S = 1.0 / 30.0
_LOWEST_M = -0.05  # of the space that is looked at: a little below the floor
_SURE_M, _BONE_M = (
    0.03,
    0.4,
)  # uncertainty of a joint on which the particles agree; lever arm of an angle's spread


@dataclass(frozen=True, slots=True, eq=False)
class _TrackedBody:
    """Carried from frame to frame. spread (18,) of the angles [rad]; full (E,) of the ellipsoids; quality 0..1."""

    t_ns: int
    place: BodyPlace
    spread: Floats
    full: Floats
    quality: float
    cameras: tuple[str, ...]


class RaoHodgesTracker:
    """For three or more calibrated cameras around a whole person; contract: `mocapd.tracking.base.Tracker`."""

    name = "rao_hodges"

    def __init__(
        self,
        rig: Rig,
        stature_m: float,
        params: Params | None = None,
        tracking: TrackingStateParams | None = None,
    ) -> None:
        self.params = p = params if params is not None else Params()
        self._stature_m = stature_m
        self._body: BodyChains = body_chains(mean_shape(stature_m))
        self._silhouettes = RigSilhouettes(rig, p)
        self._room_m = box_about(common_place(rig.cameras), p.room_m, _LOWEST_M, p.height_m)
        self._tracking = TrackingState(tracking)
        self.probe: Probe = no_probe
        self.reset()

    def reset(self, near: BodyState | None = None) -> None:
        """Resets pose and background. near: a body to continue from."""
        self._silhouettes.reset()
        self._tracking.reset(None if near is None or near.pose is None else near.t_ns)
        self._rng = np.random.default_rng(self.params.seed)
        self._near = near
        self._followed: _TrackedBody | None = None
        self._taken_over = False  # then the background behind the adopted body is unknown
        self._looks = 0

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        """Track one frame set. Raises ConfigError when a frame's size is not its calibration's."""
        require_stature(shape, self._stature_m)
        if not np.array_equal(shape.factors, self._body.shape.factors):
            self._body = body_chains(shape)
        p, views = self.params, self._silhouettes
        self._looks += 1
        views.look(frames)
        self.probe("picture")
        if self._near is not None and views.present:
            self._take_over(self._near, frames)
            self._near = None
        last = self._followed
        if last is not None and seconds(frames.t_ns - last.t_ns) > p.too_old_s:
            last = self._followed = None
        views.renew(self._looks % p.uncovered_looks == 0)
        self.probe("background")
        found = None
        if len(views.present) >= 2 and not views.are_new:
            found = self._search(last, frames)
        tracking = self._tracking.step(frames.t_ns, found is not None)
        if found is not None:
            self._followed = found
        elif tracking is Tracking.LOST:
            self._followed = None
        self._learn()
        self.probe("learn")
        return self._track(tracking, frames, shape)

    def _take_over(self, near: BodyState, frames: FrameSet) -> None:
        """Start from another tracker's body, with the picture outside it as background. The hull tests it."""
        if near.pose is None or abs(frames.t_ns - near.t_ns) > nanoseconds(self.params.too_old_s):
            return
        place = place_of(near.pose)
        n = self._body.whole
        self._followed = _TrackedBody(
            near.t_ns, place, np.zeros(n.n_dof), np.zeros(len(n.bones)), 0.0, ()
        )
        self._silhouettes.seed(self._places(place))
        self._taken_over = True

    def _search(self, last: _TrackedBody | None, frames: FrameSet) -> _TrackedBody | None:
        """The body in this frame set's hull; None without a hull, or if no body explains it."""
        p, views = self.params, self._silhouettes
        masks = views.masks()
        if last is None:
            floor = upright_place(
                self._hull(self._room_m, masks, p.room_hull).points_m, self._stature_m
            )
            if floor is None:
                return None
            cloud = self._cloud(floor, masks)
            if cloud.count == 0:
                return None
            place = start_body(self._body, floor, cloud, self._rng, p)
            spread = np.zeros(self._body.whole.n_dof)
        else:
            cloud = self._cloud(last.place.root_m, masks)
            if cloud.count == 0:
                return None
            dt_s = float(np.clip(seconds(frames.t_ns - last.t_ns), 1e-3, 4.0 * _TICK_S))
            place, spread = follow_body(self._body, last.place, cloud, dt_s, self._rng, p)
        match = match_body(self._body, place, cloud)
        inside, full = float(match.inside[0]), match.full[0]
        self.probe("particles")
        if inside < p.least_inside or full.mean() < p.least_full:
            return None
        if self._taken_over and views.outline_contrast(self._places(place)) < p.least_contrast:
            return None
        # a hull is larger than its body, by less with more cameras
        quality = float(np.sqrt(inside * full.mean()))
        names = tuple(camera.name for camera in views.cameras)
        return _TrackedBody(frames.t_ns, place, spread, full, quality, names)

    def _hull(self, box_m: Floats, masks: Sequence[Bytes], params: RayHullParams) -> HullPoints:
        """Points of the hull within a box, except where hardly any camera looks: nothing is carved there."""
        cameras = self._silhouettes.cameras
        hull = hull_points(cameras, masks, box_m, params)
        return hull.where(views_of(cameras, hull.points_m) >= max(2, len(cameras) - 1))

    def _cloud(self, middle_m: Floats, masks: Sequence[Bytes]) -> PointCloud:
        """Points of the hull about a person."""
        p = self.params
        hull = self._hull(box_about(middle_m, p.about_m, _LOWEST_M, p.height_m), masks, p.hull)
        self.probe("hull")
        if len(hull.points_m) == 0:
            return point_cloud(hull.points_m, 0.0)
        return point_cloud(hull.points_m, 1.0 / float(np.median(hull.volumes_m3)))

    def _places(self, place: BodyPlace) -> Floats:
        whole = self._body.whole
        pose = pose_limb(whole, place.angles, place.root_turn, place.root_m)
        places: Floats = places_within(whole, pose)[0]
        return places

    def _learn(self) -> None:
        """Update the backgrounds outside the body, or outside the foreground."""
        tracked = self._followed
        absorb = self._looks % self.params.absorb_looks == 0
        self._silhouettes.learn(None if tracked is None else self._places(tracked.place), absorb)

    def _track(self, tracking: Tracking, frames: FrameSet, shape: BodyShape) -> Track:
        tracked = self._followed
        if tracking is Tracking.LOST or tracked is None:
            return Track(lost_body(frames.t_ns, self.name), shape)
        away_s = seconds(frames.t_ns - tracked.t_ns)
        pose = pose_of(self._body, tracked.place)
        spread = by_joint(self._body, self._spread_of_ellipsoids(tracked.spread))
        body = BodyState(
            t_ns=frames.t_ns,
            tracking=tracking,
            tracker=self.name,
            pose=pose,
            joints_m=joint_positions(skeleton_of(shape), pose),
            confidence=by_joint(self._body, tracked.full) * confidence_fade(away_s),
            cameras=tracked.cameras if away_s == 0.0 else (),
            uncertainty_m=grow_uncertainty(np.hypot(_SURE_M, _BONE_M * spread), away_s),
        )
        return Track(body, shape, tracked.quality * confidence_fade(away_s))

    def _spread_of_ellipsoids(self, spread: Floats) -> Floats:
        """(E,) largest spread of each ellipsoid's own angles [rad]; 0 if it has none."""
        first = self._body.whole.arrays.first_dof
        return np.array([spread[a:b].max(initial=0.0) for a, b in pairwise(first)])
