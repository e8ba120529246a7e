"""Measures the agreement of two cameras' views of one person under a hypothesis of the cameras.

The rays to a joint must meet (epipolar constraint), in front of both cameras; the triangulated body must have a
person's size; and its depths must correlate with the depths that the network estimates from each single picture. The
last condition distinguishes a person from the mirror image that exchanged cameras or mirror_view pictures give.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mocapd.calibrate.consistency.person_views import PersonView
from mocapd.geometry.camera_model import centre, undistort
from mocapd.types import Camera, Floats
from mocapd.vision.heatmaps.joint_network import BODY_JOINTS

CAP_DEG = 5.0  # upper bound of errors
_NEAR_S = 0.15  # between two of a view's pictures, to interpolate
_BETWEEN_M = (0.3, 25.0)  # from each camera, where rays may meet
_LEAST = 40  # joints in common, to say anything
_ITERATIONS = 4  # of undistortion
_TORSO_M = 0.50  # as in person_views
_LEAST_PARALLAX_DEG, _NO_DEPTH = 8.0, 0.5
_HIPS, _NECK = BODY_JOINTS.index("hips"), BODY_JOINTS.index("neck")
_FEET = [BODY_JOINTS.index("leftFoot"), BODY_JOINTS.index("rightFoot")]
_LARGEST_M = 1.2  # of a joint's depth from the hips': more is a wrong match

MIRROR_OF = np.array(
    [
        BODY_JOINTS.index(name.replace("left", "*").replace("right", "left").replace("*", "right"))
        for name in BODY_JOINTS
    ]
)


@dataclass(frozen=True, slots=True, eq=False)
class PairFit:
    """How well two views agree.

    angle_deg: median angle between a ray and the other ray's epipolar plane, at most CAP_DEG; front: share of joints that
    lie before both cameras; depth: of each camera, the correlation of depths by triangulation and by its picture alone, NaN
    where the views are too short; size: of the body, relative to a person 1.75 m tall; up (3,): from hips to neck;
    floor_m: height of the lowest feet, NaN without visible feet; parallax_deg: median angle between rays that meet;
    away_m: median distance of the body from the cameras; count: joints compared.
    """

    angle_deg: float
    front: float
    depth: tuple[float, float]
    size: float
    up: Floats
    floor_m: float
    parallax_deg: float
    away_m: float
    count: int

    @property
    def cost(self) -> float:
        """Lower is better: degrees, plus a penalty for signs of a mirror image."""
        depth = min(
            (correlation for correlation in self.depth if np.isfinite(correlation)), default=0.0
        )
        # of rays that are nearly parallel depths are noise
        depth = _NO_DEPTH if self.parallax_deg < _LEAST_PARALLAX_DEG else depth
        return self.angle_deg + 0.5 * (1.0 - depth) + (1.0 - self.front)


def fit_pair(
    cameras: tuple[Camera, Camera], views: tuple[PersonView, PersonView]
) -> PairFit | None:
    """None for too little common data."""
    first, second = cameras
    a, b = views[0], resample_view(views[1], views[0].times_s)
    both = a.sure & b.sure & np.isfinite(b.px[..., 0])
    count = int(both.sum())
    if count < _LEAST:
        return None
    keep = both[..., None]
    at_a, ray_a = centre(first), _rays(first, np.where(keep, a.px, 0.0))
    at_b, ray_b = centre(second), _rays(second, np.where(keep, b.px, 0.0))
    apart = at_b - at_a
    cosine = np.einsum("fjk,fjk->fj", ray_a, ray_b)
    sine2 = np.maximum(1.0 - cosine**2, 1e-9)
    along_a, along_b = ray_a @ apart, ray_b @ apart
    far_a, far_b = (along_a - cosine * along_b) / sine2, (cosine * along_a - along_b) / sine2
    normal = np.cross(np.broadcast_to(apart, ray_a.shape), ray_a)
    normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-12)
    off_deg = np.degrees(np.abs(np.einsum("fjk,fjk->fj", normal, ray_b)))
    low, high = _BETWEEN_M
    front = (far_a > low) & (far_a < high) & (far_b > low) & (far_b < high)
    off_deg = np.where(front, np.minimum(off_deg, CAP_DEG), CAP_DEG)
    visible = both & front
    points_m = 0.5 * (at_a + far_a[..., None] * ray_a + at_b + far_b[..., None] * ray_b)
    points_m = np.where(visible[..., None], points_m, np.nan)
    torso = points_m[:, _NECK] - points_m[:, _HIPS]
    length = np.linalg.norm(torso, axis=-1)
    measurable = np.isfinite(length) & (length > 1e-6)
    up = np.full(3, np.nan)
    size = np.nan
    if measurable.sum() >= 5:
        up = np.median(torso[measurable] / length[measurable, None], axis=0)
        size = float(np.median(length[measurable])) / _TORSO_M
    feet = points_m[:, _FEET, 1]
    feet = feet[np.isfinite(feet)]
    floor_m = float(np.percentile(feet, 20)) if len(feet) >= 10 else np.nan
    depth = (_depth(first, a, points_m, size), _depth(second, b, points_m, size))
    parallax_deg = float(np.median(np.degrees(np.arccos(np.clip(np.abs(cosine[both]), 0.0, 1.0)))))
    away_m = float(np.median(0.5 * (far_a + far_b)[visible])) if visible.any() else np.nan
    return PairFit(
        float(np.median(off_deg[both])), float(front[both].mean()), depth, size, up, floor_m, parallax_deg, away_m, count
    )  # fmt: skip


def _rays(camera: Camera, px: Floats) -> Floats:
    """Unit directions (...,3) of pixels (...,2), in the world, to a tenth of a pixel."""
    distorted = (px - camera.K[:2, 2]) / camera.K[[0, 1], [0, 1]]
    xy = undistort(camera.dist, distorted, _ITERATIONS)
    ray = np.concatenate([xy, np.ones_like(xy[..., :1])], axis=-1) @ camera.R
    return np.asarray(ray / np.linalg.norm(ray, axis=-1, keepdims=True))


def _depth(camera: Camera, view: PersonView, points_m: Floats, size: float) -> float:
    """Correlation of joint depths relative to the hips, triangulated and estimated from one picture."""
    depth_m = (points_m - centre(camera)) @ camera.R[2]
    by_rays = (depth_m - depth_m[:, _HIPS : _HIPS + 1]) / max(size, 1e-3)
    use = np.isfinite(by_rays) & np.isfinite(view.farther_m) & (np.abs(by_rays) < _LARGEST_M)
    use[:, _HIPS] = False
    if use.sum() < _LEAST:
        return np.nan
    x, y = by_rays[use], view.farther_m[use]
    # about 0, not about the mean: both are relative to the hips
    return float((x * y).sum() / max(np.sqrt((x * x).sum() * (y * y).sum()), 1e-9))


def resample_view(view: PersonView, times_s: Floats) -> PersonView:
    """The view at other times (N,) [s]; NaN and unreliable without a picture near."""
    own = view.times_s
    after = np.clip(np.searchsorted(own, times_s), 1, max(len(own) - 1, 1))
    if len(own) < 2:
        after = np.zeros(len(times_s), dtype=int)
    before = np.maximum(after - 1, 0)
    step = np.maximum(own[after] - own[before], 1e-9)
    share = np.clip((times_s - own[before]) / step, 0.0, 1.0)
    near = (np.abs(own[before] - times_s) < _NEAR_S) & (np.abs(own[after] - times_s) < _NEAR_S)
    w = share[:, None]
    px = (1 - w[..., None]) * view.px[before] + w[..., None] * view.px[after]
    spread = np.maximum(view.spread[before], view.spread[after])
    spread = np.where(near[:, None], spread, np.inf)
    farther = (1 - w) * view.farther_m[before] + w * view.farther_m[after]
    return replace(view, times_s=times_s, px=px, spread=spread, farther_m=farther)


def thin_view(view: PersonView) -> PersonView:
    """Every second picture of a view."""
    return PersonView(
        view.times_s[::2], view.px[::2], view.spread[::2], view.farther_m[::2], view.quarter_turns
    )


def mirror_view(view: PersonView, width_px: int) -> PersonView:
    """The view of the picture's mirror image: left and right change, too."""
    px = view.px[:, MIRROR_OF].copy()
    px[..., 0] = width_px - 1 - px[..., 0]
    return replace(
        view, px=px, spread=view.spread[:, MIRROR_OF], farther_m=view.farther_m[:, MIRROR_OF]
    )


def upside_down(view: PersonView, size_px: tuple[int, int]) -> PersonView:
    """The view of the picture rotated by 180 degrees."""
    return replace(view, px=np.array([size_px[0] - 1.0, size_px[1] - 1.0]) - view.px)


def zoom_view(view: PersonView, middle_px: Sequence[float], factor: float) -> PersonView:
    """The view of the picture enlarged about a point."""
    middle = np.asarray(middle_px)
    return replace(view, px=(view.px - middle) * factor + middle)
