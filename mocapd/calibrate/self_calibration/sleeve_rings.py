"""Finds the rings between neighbouring patches of a sleeve in a classified picture.

Half of a ring is visible. It ends at the arm's outline, and the point midway between its ends is the ring's own
middle from any viewpoint: exact for a circle in affine projection, within 1 mm at 2 m. So it is one point of the arm for
all cameras, and needs no model of the sleeve's surface.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mocapd.body.skeleton import INDEX
from mocapd.calibrate.self_calibration.patch_tracks import PatchSighting
from mocapd.geometry.camera_model import normalised, project
from mocapd.shirt.standard_shirt import standard_shirt
from mocapd.types import Camera, Floats

Mask = NDArray[np.bool_]

N_ALONG = 4  # rings of an arm, from the shoulder to the cuff's end
SIDES = ("left", "right")

_STEP_PX = 0.5  # of samples, in work px
_STEEPEST = 0.75  # sine of the arm's direction with the view
_ACROSS_M, _BESIDE_M = 0.09, 0.02  # half of the window across the arm; cloth required on each side
_LEAST_M = 0.03
_CONFIRMED = 0.5  # least share of that cloth with its colour
_GAP = 5  # samples that a fold may remove from a row
_BEND_SD = 0.12  # uncertainty of the ring's bend from the arm's direction, of half its width
_SLOPE_SD = 0.25
_NOISE_PX = 1.0
_SEEN = 0.7  # least share of the ring's width with a border


@dataclass(frozen=True, slots=True, eq=False)
class _Ring:
    """at: along the bone from its first joint (0) to its second (1); before, after (11,): colours on
    both sides; reach_m: window along the arm; band_m: where the arm is straight."""

    side: str
    bone: tuple[str, str]
    at: float
    before: Mask
    after: Mask
    reach_m: float
    band_m: float
    ends: bool = False  # no cloth after it
    bends: bool = False  # an elbow


@dataclass(frozen=True, slots=True, eq=False)
class _Window:
    """A picture's ids (U,V) rotated along an arm about a point: across u (U,), along v (V,) in work px;
    n, a (2,): the picture's directions of u and v."""

    n: Floats
    a: Floats
    u: Floats
    v: Floats
    ids: NDArray[np.uint8]


def sleeve_rings(
    sighting: PatchSighting, joints_m: Floats, camera: Camera, image_scale: int
) -> tuple[Floats, Floats]:
    """Middles (2 N_ALONG, 2) in undistorted normalised coordinates and half widths (2 N_ALONG,) [m],
    left arm first; NaN for a ring that is not wholly visible.

    joints_m (J,3): approximate body in the camera's frame; its arms' directions give the bend of a ring.
    image_scale: frame px by work px.
    """
    xy, half_m = np.full((len(_RINGS), 2), np.nan), np.full(len(_RINGS), np.nan)
    alone = replace(camera, R=np.eye(3), t_m=np.zeros(3))
    corner = np.array(sighting.roi_px[:2], dtype=np.float64) + (image_scale - 1) / 2
    for i, ring in enumerate(_RINGS):
        at_m, along = _place(ring, joints_m)
        tilt = float(along @ at_m) / max(float(np.linalg.norm(at_m)), 1e-9)
        if at_m[2] < 0.3 or abs(tilt) > _STEEPEST:
            continue
        px: Floats = project(alone, np.stack([at_m - 0.01 * along, at_m, at_m + 0.01 * along]))
        direction = px[2] - px[0]
        result = _find(
            ring, sighting.ids, (px[1] - corner) / image_scale,
            direction / float(np.linalg.norm(direction)), tilt,
            float(at_m[2]) / float(camera.K[0, 0]) * image_scale,
        )  # fmt: skip
        if result is not None:
            middle, half_m[i] = result
            xy[i] = normalised(camera, (middle * image_scale + corner)[None])[0]
    return xy, half_m


def _place(ring: _Ring, joints_m: Floats) -> tuple[Floats, Floats]:
    """Position of a ring (3,) [m], and the arm's direction (3,) there."""
    a, b = (joints_m[INDEX[ring.side + bone]] for bone in ring.bone)
    along = (b - a) / max(np.linalg.norm(b - a), 1e-6)
    if ring.bends:
        wrist = joints_m[INDEX[ring.side + "Hand"]]
        along = along + (wrist - b) / max(np.linalg.norm(wrist - b), 1e-6)
        along /= max(np.linalg.norm(along), 1e-6)
    return a + ring.at * (b - a), along


def _find(
    ring: _Ring, ids: NDArray[np.uint8], c: Floats, a: Floats, tilt: float, px_m: float
) -> tuple[Floats, float] | None:
    """A ring's middle (2,) in work px and half its width [m]; searches about c along a (2,)."""
    result: tuple[Floats, float] | None = None
    for last in (False, True):  # again about the first result
        window = _window(ids, c, a, ring.reach_m / px_m, _ACROSS_M / px_m)
        border = _border(ring, window, px_m)
        if border is None:
            return None
        good, v = border
        near = good & (np.abs(window.u) * px_m < 0.04)
        if np.count_nonzero(good) * _STEP_PX * px_m < _LEAST_M or not near.any():
            return None
        about = float(np.median(v[near]))
        outline = _outline(ring, window, about, ring.band_m / px_m)
        if outline is None:
            return None
        middle, slope, half = outline
        along, visible = _bend(window.u, v, good, middle, half, tilt)
        if visible < (_SEEN if last else 0.5):
            return None
        c = c + (middle + slope * (along - about)) * window.n + along * window.a
        if not ring.bends:
            a = window.a + slope * window.n
            a = a / np.linalg.norm(a)
        result = c, half * px_m
    return result


def _window(ids: NDArray[np.uint8], c: Floats, a: Floats, reach: float, across: float) -> _Window:
    """ids about c, nearest samples; 0 beyond the picture."""
    n = np.array([-a[1], a[0]])
    u = np.arange(-int(across / _STEP_PX), int(across / _STEP_PX) + 1, dtype=np.float64) * _STEP_PX
    v = np.arange(-int(reach / _STEP_PX), int(reach / _STEP_PX) + 1, dtype=np.float64) * _STEP_PX
    at = np.rint(c + u[:, None, None] * n + v[None, :, None] * a).astype(np.int64)
    h, w = ids.shape
    x, y = at[..., 0], at[..., 1]
    inside = (x >= 0) & (x < w) & (y >= 0) & (y < h)
    visible = np.where(inside, ids[np.clip(y, 0, h - 1), np.clip(x, 0, w - 1)], 0).astype(np.uint8)
    return _Window(n, a, u, v, visible)


def _border(ring: _Ring, window: _Window, px_m: float) -> tuple[Mask, Floats] | None:
    """By row across the arm: whether both patches are there, and where (U,) along v one ends.

    There the fewest samples have the colour of the other side.
    """
    n_u, n_v = window.ids.shape
    count = np.zeros((2, n_u, n_v + 1), np.int64)
    count[0, :, 1:] = np.cumsum(ring.before[window.ids], axis=1)
    count[1, :, 1:] = np.cumsum(ring.after[window.ids], axis=1)
    wrong = count[1] + count[0][:, -1:] - count[0]
    least = wrong == wrong.min(axis=1, keepdims=True)
    ties = least.sum(axis=1)
    first, last = least.argmax(axis=1), n_v - least[:, ::-1].argmax(axis=1)
    k = (least * np.arange(n_v + 1)).sum(axis=1) / ties
    q = max(2, int(_BESIDE_M / px_m / _STEP_PX))
    rows, cut = np.arange(n_u), np.rint(k).astype(np.int64)
    before = count[0][rows, cut] - count[0][rows, np.maximum(cut - q, 0)]
    after = count[1][rows, np.minimum(cut + q, n_v)] - count[1][rows, cut]
    good = (last - first + 1 == ties) & (last - first <= _GAP)
    good &= (before >= _CONFIRMED * q) & (after >= _CONFIRMED * q)
    return (good, window.v[0] - _STEP_PX / 2 + k * _STEP_PX) if good.any() else None


def _outline(
    ring: _Ring, window: _Window, about: float, band: float
) -> tuple[float, float, float] | None:
    """The sleeve's middle line u = middle + slope (v - about) near a ring, and half its width."""
    cloth = ring.before[window.ids]
    near = np.abs(window.v - about) <= band
    if ring.ends:
        near &= window.v < about - 1.0
    else:
        cloth = cloth | ring.after[window.ids]
    rows = []
    for j in np.flatnonzero(near):
        run = _run(cloth[:, j])
        if run is not None and run[0] > 0 and run[1] < len(window.u):
            lower, upper = window.u[run[0]], window.u[run[1] - 1]
            rows.append((window.v[j] - about, (lower + upper) / 2, (upper - lower + _STEP_PX) / 2))
    if len(rows) < 3:
        return None
    v, middle, half = np.array(rows).T
    usual = float(np.median(half))
    good = np.abs(half - usual) < max(0.12 * usual, 0.8)
    if np.count_nonzero(good) < max(3, 0.6 * len(rows)):
        return None
    if ring.bends:
        return float(np.median(middle[good])), 0.0, usual
    slope, at = np.polyfit(v[good], middle[good], 1)
    return float(at), float(slope), usual


def _run(cloth: Mask) -> tuple[int, int] | None:
    """Bounds of the one piece of samples (U,) that is most of the arm."""
    visible = np.flatnonzero(cloth)
    if not len(visible):
        return None
    breaks = np.flatnonzero(np.diff(visible) > _GAP + 1)
    first = np.concatenate([[0], breaks + 1])
    last = np.concatenate([breaks, [len(visible) - 1]])
    start, end = visible[first], visible[last] + 1
    centre = len(cloth) // 2
    worth = end - start - np.maximum(0, np.maximum(start - centre, centre - end))
    best = int(np.argmax(worth))
    return int(start[best]), int(end[best])


def _bend(
    u: Floats, v: Floats, good: Mask, middle: float, half: float, tilt: float
) -> tuple[float, float]:
    """Position along the arm of the ends of a half ellipse, and the share of its width with a border.

    v = v0 + slope s + bend sqrt(1 - s^2) with s across, -1 to 1; the bend of a circle viewed under the angle
    asin(tilt) is half its width times tilt. Re-weighted by Geman-McClure.
    """
    s = (u - middle) / half
    used = good & (np.abs(s) < 0.93)
    if np.count_nonzero(used) < 6:
        return 0.0, 0.0
    s, v = s[used], v[used]
    D = np.stack([np.ones_like(s), s, np.sqrt(1.0 - s**2)], axis=1)
    prior = np.array([0.0, (_SLOPE_SD * half) ** -2, (_BEND_SD * half) ** -2])
    usual = prior * np.array([0.0, 0.0, half * tilt])
    weight = 1.0 / (1.0 + ((v - np.median(v)) / (0.6 * half)) ** 4)
    fitted, away = np.zeros(3), v
    for _ in range(6):
        W = weight[:, None] / _NOISE_PX**2
        fitted = np.linalg.solve(D.T @ (D * W) + np.diag(prior), (D * W).T @ v + usual)
        away = v - D @ fitted
        weight = (1.0 + (away / 0.8) ** 2) ** -2
    visible = np.count_nonzero(np.abs(away) < 1.6) * _STEP_PX / (2 * 0.93 * half)
    return float(fitted[0]), float(visible)


def _rings() -> tuple[_Ring, ...]:
    shirt = standard_shirt()

    def colours(side: str, *patches: str) -> Mask:
        out = np.zeros(11, np.bool_)
        for patch in patches:
            index = shirt.patch_names.index(f"{side}_{patch}") + 1
            out[shirt.colour_of_patch[index]] = True
        return out

    out = []
    for side in SIDES:
        upper = colours(side, "upper_arm_front", "upper_arm_back")
        fore = colours(side, "forearm_front", "forearm_back")
        cuff, arm, forearm = colours(side, "cuff"), ("UpperArm", "LowerArm"), ("LowerArm", "Hand")
        out += [
            _Ring(side, arm, 0.45, colours(side, "shoulder"), upper, 0.075, 0.025),
            _Ring(side, arm, 1.0, upper, fore, 0.05, 0.010, bends=True),
            _Ring(side, forearm, 0.55, fore, cuff, 0.075, 0.025),
            _Ring(side, forearm, 0.95, cuff, ~cuff, 0.06, 0.025, ends=True),
        ]
    return tuple(out)


_RINGS = _rings()
