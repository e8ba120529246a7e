"""The cylinder model: two frusta for each limb, two for the trunk, one for the head, and the trunk's elliptic cross-sections.

Radii are read off the surface of the body in its clothes. Frusta end at points, or at five ends more that are made from the
points: the middles of shoulders, waist and hips, chin and crown.
"""

from dataclasses import dataclass

import numpy as np

from mocapd.body.arm_tubes import arm_tube
from mocapd.body.leg_tubes import leg_tube
from mocapd.body.shape import BodyShape
from mocapd.body.trunk_tubes import head_tube, torso_tube
from mocapd.published.hecht2009.mass_spring.body_points import (
    ANKLE,
    ELBOW,
    HEAD,
    HIP,
    KNEE,
    N_POINTS,
    NECK,
    SHOULDER,
    WAIST,
    WRIST,
    head_ahead_m,
    head_forward,
)
from mocapd.types import Floats, Ints, Skeleton

MID_SHOULDERS, MID_WAIST, MID_HIPS, CHIN, CROWN = range(N_POINTS, N_POINTS + 5)
N_ENDS = N_POINTS + 5
NAMES = (
    "head", "upper_trunk", "lower_trunk",
    "left_upper_arm", "left_forearm", "right_upper_arm", "right_forearm",
    "left_thigh", "left_shank", "right_thigh", "right_shank",
)  # fmt: skip
_HALF_HEAD = 0.065  # from the head's middle to chin or crown, in statures


@dataclass(frozen=True, slots=True, eq=False)
class Frusta:
    """C frusta in the order of NAMES.

    index (C,2): rows of `ends_of` where each starts and ends; radii_m (C,2): half the breadth there in the frontal view;
    half_head_m: from the head's middle to chin and crown; head_ahead_m: of its middle in front of the point HEAD.
    """

    index: Ints
    radii_m: Floats
    half_head_m: float
    head_ahead_m: float

    def ends_of(self, points_m: Floats) -> Floats:
        """The ends (...,21,3) of a body's points (...,16,3) [m]."""
        return frustum_ends(points_m, self.half_head_m, self.head_ahead_m)

    def ends_m(self, points_m: Floats) -> Floats:
        """Where each frustum of a body of points (16,3) starts and ends (C,2,3) [m]."""
        ends: Floats = self.ends_of(points_m)[self.index]
        return ends


def frustum_ends(points_m: Floats, half_head_m: float, head_ahead_m: float) -> Floats:
    """Points (...,16,3) and the ends made from them (...,21,3) [m]: chin and crown lie along the neck through the head's
    middle."""
    p = np.asarray(points_m, dtype=float)
    out = np.empty((*p.shape[:-2], N_ENDS, 3))
    out[..., :N_POINTS, :] = p
    for end, (left, right) in ((MID_SHOULDERS, SHOULDER), (MID_WAIST, WAIST), (MID_HIPS, HIP)):
        out[..., end, :] = 0.5 * (p[..., left, :] + p[..., right, :])
    up = p[..., HEAD, :] - p[..., NECK, :]
    up = up * (half_head_m / np.maximum(np.sqrt(np.vecdot(up, up)), 1e-9)[..., None])
    middle = p[..., HEAD, :] + head_ahead_m * head_forward(p)
    out[..., CHIN, :], out[..., CROWN, :] = middle - up, middle + up
    return out


def build_frusta(shape: BodyShape, skeleton: Skeleton, rest_m: Floats) -> Frusta:
    """The frusta of a shape; skeleton: its own, rest_m (16,3): its points in the T-pose [m]."""
    half_head = _HALF_HEAD * shape.stature_m * shape.factor("head_size")
    ahead = head_ahead_m(shape, skeleton)
    ends = frustum_ends(rest_m, half_head, ahead)
    torso = torso_tube(shape, skeleton).rings_m
    trunk = trunk_ellipses(shape, skeleton, rest_m)
    index = [(CHIN, CROWN), (MID_SHOULDERS, MID_WAIST), (MID_WAIST, MID_HIPS)]
    rings = [head_tube(shape, skeleton).rings_m, torso, torso]
    for s, side in enumerate(("left", "right")):
        index += [(SHOULDER[s], ELBOW[s]), (ELBOW[s], WRIST[s])]
        rings += [arm_tube(shape, skeleton, side).rings_m] * 2
    for s, side in enumerate(("left", "right")):
        index += [(HIP[s], KNEE[s]), (KNEE[s], ANKLE[s])]
        rings += [leg_tube(shape, skeleton, side).rings_m] * 2
    radii = np.array([
        _end_radii(tube, ends[a], ends[b]) for tube, (a, b) in zip(rings, index, strict=True)
    ])  # fmt: skip
    radii[1], radii[2] = trunk[:2, 0], trunk[1:, 0]
    return Frusta(np.array(index), radii, half_head, ahead)


def trunk_ellipses(shape: BodyShape, skeleton: Skeleton, rest_m: Floats) -> Floats:
    """Cross-sections at shoulders, waist and hips (3,3) [m]: half breadth, half depth, and how far the middle is in
    front of the points. That of the shoulders is the chest's below them: above it the surface is that of the shoulders."""
    rings = torso_tube(shape, skeleton).rings_m
    y = rings[:, :, 1].mean(axis=1)
    wide = np.abs(rings[:, :, 0]).max(axis=1)
    back, front = rings[:, :, 2].min(axis=1), rings[:, :, 2].max(axis=1)
    out = np.empty((3, 3))
    for level, (left, right) in enumerate((SHOULDER, WAIST, HIP)):
        at = 0.5 * (rest_m[left] + rest_m[right])
        height = at[1] if level else at[1] - 0.25 * (at[1] - rest_m[WAIST[0], 1])
        b, f, w = (np.interp(height, y, values) for values in (back, front, wide))
        out[level] = w, 0.5 * (f - b), 0.5 * (f + b) - at[2]
    return out


def _end_radii(rings_m: Floats, start_m: Floats, end_m: Floats) -> Floats:
    """Radii (2,) at both ends [m] of the frustum that is nearest to rings (R,C,3) between them."""
    middle = rings_m.mean(axis=1)
    radius = np.linalg.norm(rings_m - middle[:, None], axis=2).mean(axis=1)
    along = (middle - start_m) @ (end_m - start_m) / np.sum((end_m - start_m) ** 2)
    inside = (along >= 0.0) & (along <= 1.0)
    slope, start = np.polyfit(along[inside], radius[inside], 1)
    return np.array([start, start + slope])
