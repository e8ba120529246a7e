"""Distance of a head from one camera, by the same face in a close second camera.

Plane sweep (Collins, A space-sweep approach to true multi-image matching, CVPR 1996) with the front of a ball in the
place of the plane: each distance maps the face's pixels to the other picture, and the correlation of the grey values
scores it. Needs no rectified pictures.
"""

from dataclasses import dataclass

import numpy as np

from mocapd.body.arrays import CameraArrays
from mocapd.geometry.camera_model import centre, rays
from mocapd.published.hecht2009.head.stereo_sweep_kernels import sweep
from mocapd.types import Bytes, Camera, Floats

WIDEST_RAD = 0.35  # between the two views of a point; beyond, they show different sides of a head
_LEAST_CORRELATION = 0.6
_LEAST_CONTRAST = 4.0  # standard deviation of grey values that says anything, 0..255
_ROWS = 15  # of samples over the patch
_STEP_PX = 0.6  # of disparity from one distance to the next
_INDEPENDENT = 0.25  # share of the samples: neighbours see the same
_MATCH_SD_PX = 0.15  # of a match, which model and sampling leave at best
_RIVAL = 0.06  # correlation within which another peak makes the distance ambiguous


@dataclass(frozen=True, slots=True)
class Distance:
    """Along a camera's ray [m], one standard deviation [m], and the correlation there."""

    distance_m: float
    sigma_m: float
    correlation: float


@dataclass(frozen=True, slots=True, eq=False)
class StereoView:
    """A camera with its grey picture (h,w) and what kernels need of it."""

    camera: Camera
    arrays: CameraArrays
    grey: Bytes


def view_angle_rad(a: Camera, b: Camera, point_m: Floats) -> float:
    """Between the rays of two cameras to a point in the world."""
    to_a, to_b = centre(a) - point_m, centre(b) - point_m
    cosine = to_a @ to_b / max(float(np.linalg.norm(to_a) * np.linalg.norm(to_b)), 1e-12)
    return float(np.arccos(np.clip(cosine, -1.0, 1.0)))


def swept_distance(
    near: StereoView,
    other: StereoView,
    middle_px: Floats,
    half_px: float,
    between_m: tuple[float, float],
    radius_m: float,
    motion_m: Floats | None = None,
) -> Distance | None:
    """Of the ball whose picture in `near` has its middle at middle_px (2,); half_px: of the patch that is compared.

    between_m: range of the sweep; motion_m (3,): the ball's motion in the world until the exposure of `other`. None: no
    distance fits, or two do, or the patch has no contrast.
    """
    pixels = middle_px + half_px * _SAMPLES
    values = _sample(near.grey, pixels)
    if values is None or float(values.std()) < _LEAST_CONTRAST:
        return None
    from_m, middle_ray, directions = _patch_rays(near.camera, middle_px, half_px)
    cosine = directions @ middle_ray
    lateral = np.sqrt(np.maximum(1.0 / cosine**2 - 1.0, 0.0))
    distances = _distances(near.camera, other.camera, middle_ray, between_m)
    correlation = np.empty(len(distances))
    R, t, K, dist = other.arrays
    seen_by = CameraArrays(R, t if motion_m is None else t + R @ motion_m, K, dist)
    sweep(
        np.ascontiguousarray(from_m), directions, lateral, values, distances, radius_m, seen_by, other.grey,
        correlation,
    )  # fmt: skip
    return _peak(distances, correlation, len(pixels))


def _patch_rays(camera: Camera, middle_px: Floats, half_px: float) -> tuple[Floats, Floats, Floats]:
    """The camera's centre (3,), the unit ray (3,) through the patch's middle and those of its samples (N,3).

    Over a patch the lens is linear: three pixels are freed of distortion instead of all.
    """
    corners = middle_px + half_px * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    from_m, three = rays(camera, corners)
    three = three / (three @ camera.R[2])[:, None]
    directions = three[0] + _SAMPLES @ (three[1:] - three[0])
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return from_m, three[0] / np.linalg.norm(three[0]), np.ascontiguousarray(directions)


def _disc() -> Floats:
    """Samples (N,2) over the unit disc."""
    line = np.linspace(-1.0, 1.0, _ROWS)
    grid = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)
    inside: Floats = grid[np.linalg.norm(grid, axis=1) <= 1.0]
    return inside


_SAMPLES = _disc()


def _sample(grey: Bytes, pixels: Floats) -> Floats | None:
    """Bilinear grey values (N,) at pixels (N,2); None when one lies outside."""
    h, w = grey.shape
    corner = np.floor(pixels).astype(np.int64)
    if (corner < 0).any() or (corner >= (w - 1, h - 1)).any():
        return None
    (i, j), (a, b) = corner.T, (pixels - corner).T
    top = (1.0 - a) * grey[j, i] + a * grey[j, i + 1]
    low = (1.0 - a) * grey[j + 1, i] + a * grey[j + 1, i + 1]
    values: Floats = (1.0 - b) * top + b * low
    return values


def _distances(
    near: Camera, other: Camera, direction: Floats, between_m: tuple[float, float]
) -> Floats:
    """Distances, even in disparity, so that the match moves less than a pixel from one to the next."""
    ends = 1.0 / np.array(between_m)
    aside = centre(other) - centre(near)
    across_m = float(np.linalg.norm(aside - direction * (aside @ direction)))
    disparity_px = abs(ends[0] - ends[1]) * across_m * float(other.K[0, 0])
    n = int(np.clip(np.ceil(disparity_px / _STEP_PX), 6, 400)) + 1
    return np.ascontiguousarray(1.0 / np.linspace(ends[0], ends[1], n))


def _peak(distances: Floats, correlation: Floats, n_samples: int) -> Distance | None:
    """The best distance, between the samples by a parabola in inverse distance; its spread by least squares.

    For normalised signals the sum of squared differences is 2 N (1 - correlation), so that the curvature c of the
    peak gives the variance (1 - correlation) / (N c).
    """
    best = int(np.argmax(correlation))
    top = float(correlation[best])
    if top < _LEAST_CORRELATION or best in (0, len(distances) - 1):
        return None
    before, after = float(correlation[best - 1]), float(correlation[best + 1])
    bend = 2.0 * top - before - after
    if before < 0.0 or after < 0.0 or bend <= 1e-6:
        return None
    inner = correlation[1:-1]
    peaks = 1 + np.flatnonzero((inner > correlation[:-2]) & (inner >= correlation[2:]))
    rivals = peaks[(np.abs(peaks - best) > 2) & (correlation[peaks] > top - _RIVAL)]
    if len(rivals):
        return None
    step = float(1.0 / distances[best + 1] - 1.0 / distances[best])
    inverse = 1.0 / distances[best] + 0.5 * step * (after - before) / bend
    variance = (1.0 - top) / (_INDEPENDENT * n_samples * bend)
    sigma_steps = np.sqrt(variance + (_MATCH_SD_PX / _STEP_PX) ** 2)
    distance = float(1.0 / inverse)
    return Distance(distance, float(sigma_steps * abs(step) * distance**2), top)
