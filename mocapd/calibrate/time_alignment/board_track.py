"""The board's trajectory in one camera's frame: its outer corners over time, by that camera's intrinsics alone."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from mocapd.geometry.rigid_transforms import RigidTransform, stack
from mocapd.types import Floats, Ints

_LONGEST_STEP = 2.6  # of the usual step between two pictures; no interpolation over a longer one
_SAME_S = 1e-4  # times this near are one time
_UNEVEN = 0.5  # largest error of the board's interpolated place, as a part of its motion, of continuous pictures


@dataclass(frozen=True, slots=True, eq=False)
class BoardTrack:
    """T pictures with the board: times_s (T,) rising, points_m (T,4,3) its outer corners in the camera's frame,
    speed_mps (T,4,3) of them, indices (T,) of the pictures; focal_px; period_s of the camera's frames, step_s between
    the examined ones.

    `followed`: the pictures are near enough in time to interpolate the board's motion.
    """

    times_s: Floats
    points_m: Floats
    speed_mps: Floats
    indices: Ints
    focal_px: float
    period_s: float
    step_s: float
    followed: bool

    def thin(self, most: int) -> "BoardTrack":
        """At most so many of its pictures, evenly."""
        rows = slice(None, None, max(1, -(-len(self.times_s) // most)))
        return replace(
            self,
            times_s=self.times_s[rows],
            points_m=self.points_m[rows],
            speed_mps=self.speed_mps[rows],
            indices=self.indices[rows],
        )

    def at(self, times_s: Floats) -> Floats:
        """(...,4,3) [m]: the corners at any times (...), NaN without a continuous track then.

        Cubic Hermite interpolation.
        """
        if len(self.times_s) < 2:
            return np.full((*times_s.shape, 4, 3), np.nan)
        after = np.clip(np.searchsorted(self.times_s, times_s), 1, len(self.times_s) - 1)
        start_s, end_s = self.times_s[after - 1], self.times_s[after]
        step_s = end_s - start_s
        u = ((times_s - start_s) / step_s)[..., None, None]
        step = step_s[..., None, None]
        points = (
            (1.0 + 2.0 * u) * (1.0 - u) ** 2 * self.points_m[after - 1]
            + u**2 * (3.0 - 2.0 * u) * self.points_m[after]
            + step * u * (1.0 - u) ** 2 * self.speed_mps[after - 1]
            - step * u**2 * (1.0 - u) * self.speed_mps[after]
        )
        near_start = np.abs(times_s - start_s) < _SAME_S
        near_end = np.abs(times_s - end_s) < _SAME_S
        between = (times_s > start_s) & (times_s < end_s)
        interpolated = between & (step_s <= _LONGEST_STEP * self.step_s) & self.followed
        points[~(interpolated | near_start | near_end)] = np.nan
        points[near_start] = self.points_m[after - 1][near_start]
        points[near_end] = self.points_m[after][near_end]
        return points

    def pixels(self, points_m: Floats) -> Floats:
        """(...,2) [px] from the axis of points (...,3) in this camera's frame, as without distortion."""
        depth_m = np.maximum(points_m[..., 2:], 1e-3)
        return self.focal_px * points_m[..., :2] / depth_m


def board_track(
    poses: Mapping[int, RigidTransform],
    times_s: Mapping[int, float],
    outline_m: Floats,
    focal_px: float,
    period_s: float,
    step_s: float,
) -> BoardTrack:
    """The track of poses camera_from_board by picture; `times_s[picture]`; outline_m (4,3) on the board."""
    indices = np.array(sorted(poses), dtype=np.int64)
    at_s = np.array([times_s[index] for index in indices.tolist()])
    poses_of = stack([poses[index] for index in indices.tolist()])
    points_m = poses_of[:, None].apply(outline_m)
    speed = _speeds(at_s, points_m, _LONGEST_STEP * step_s)
    followed = _is_followed(at_s, points_m, _LONGEST_STEP * step_s)
    return BoardTrack(at_s, points_m, speed, indices, focal_px, period_s, step_s, followed)


def _speeds(times_s: Floats, points_m: Floats, longest_s: float) -> Floats:
    """(T,4,3): slope of the parabola through a picture and its neighbours, or of the line to the only one."""
    if len(times_s) < 2:
        return np.zeros_like(points_m)
    step_s = np.diff(times_s)
    near = step_s <= longest_s
    slope = np.diff(points_m, axis=0) / step_s[:, None, None]
    none = np.zeros((1, *points_m.shape[1:]))
    before, after = np.concatenate([none, slope]), np.concatenate([slope, none])
    # a distant neighbour has no weight; the nearer of two weighs more
    left = np.append(0.0, np.where(near, 1.0 / step_s, 0.0))[:, None, None]
    right = np.append(np.where(near, 1.0 / step_s, 0.0), 0.0)[:, None, None]
    speed: Floats = (left * before + right * after) / np.maximum(left + right, 1e-12)
    return speed


def _is_followed(times_s: Floats, points_m: Floats, longest_s: float) -> bool:
    """Whether a picture's neighbours predict it; False for single pictures of a board at rest."""
    if len(times_s) < 5:
        return False
    whole_s = times_s[2:] - times_s[:-2]
    u = ((times_s[1:-1] - times_s[:-2]) / whole_s)[:, None, None]
    foretold = (1.0 - u) * points_m[:-2] + u * points_m[2:]
    near = whole_s <= 2.0 * longest_s
    if near.sum() < 3:
        return False
    off_m = np.linalg.norm(foretold - points_m[1:-1], axis=2).mean(axis=1)[near]
    way_m = np.linalg.norm(points_m[2:] - points_m[:-2], axis=2).mean(axis=1)[near]
    return bool(np.median(off_m) < _UNEVEN * np.median(way_m) or np.median(way_m) < 0.01)
