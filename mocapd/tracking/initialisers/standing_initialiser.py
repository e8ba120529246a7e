"""The first pose of an upright person, from silhouettes in the foreground."""

from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import cv2
import numpy as np
from numpy.typing import NDArray

from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.fit.fit_result import Fit
from mocapd.fit.idmap_renderer import Roi
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.term import Term
from mocapd.fit.view import View
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import centre, project, rays
from mocapd.tracking.cues.clothes.clothes_params import StartParams
from mocapd.types import Bytes, Camera, Floats
from mocapd.vision.foreground_kernels import BEFORE, UNKNOWN, stands

_ONE_SIDE = 0.6  # length of the mean direction to the cameras, above which they stand on one side
_ADJACENT = 0.99  # the same of adjacent cameras: less than 16 degrees between two
_PAST_RAD = 1.2  # to either side: one fit does not turn by a quarter
_UPRIGHT = 0.85  # of the hips' height: two shadows, or pieces of one body, are explained by one that squats
_ON_FLOOR_M = 0.25  # of both ankles on average: one foot may be raised, or both be on a step
_ANKLES = [INDEX[side + "Foot"] for side in SIDES]
_ABOUT_PX = 20  # of a blob, within which its body is drawn


@dataclass(frozen=True, slots=True, eq=False)
class Blob:
    """A connected component of a camera's foreground: mask (h,w) uint8 in the region roi, has_background: pixels with a
    background model, upper and lower edge of its box and its mean column [work px]."""

    mask: Bytes
    has_background: NDArray[np.bool_]
    roi: Roi
    top: float
    bottom: float
    middle_x: float


@dataclass(frozen=True, slots=True, eq=False)
class PersonCandidate:
    """A person of the given stature at place_m (3,) on the floor, with a blob for each camera index; error [work px^2]."""

    place_m: Floats
    blobs: Mapping[int, Blob]
    error: float


def blobs_of(before: Bytes, shadows: bool, params: StartParams) -> list[Blob]:
    """The largest components that may be people, largest first, joined across pixels without a background model. shadows:
    include possible shadows, which may be dark cloth."""
    mask, has_background = stands(before) if shadows else before == BEFORE, before != UNKNOWN
    n, numbered, stats, middles = cv2.connectedComponentsWithStats(
        (mask | ~has_background).astype(np.uint8)
    )
    order = sorted(range(1, n), key=lambda k: -int(stats[k, cv2.CC_STAT_AREA]))[: params.blobs]
    out = []
    for k in order:
        left, top, width, height, area = stats[k].tolist()
        if area >= params.least_px and height >= params.least_height_px:
            piece = numbered == k
            out.append(_blob(piece, before, (left, top, width, height), float(middles[k, 0])))
    return out


def blob_within(before: Bytes, covered: Bytes) -> Blob | None:
    """What stands, or throws a shadow, where `covered` (h,w) is not 0; None for nothing."""
    mask = stands(before) & (covered > 0)
    if not mask.any():
        return None
    left, top, width, height = cv2.boundingRect(mask.astype(np.uint8))
    return _blob(mask, before, (left, top, width, height), float(np.nonzero(mask)[1].mean()))


def _blob(
    mask: NDArray[np.bool_], before: Bytes, box: tuple[int, int, int, int], middle_x: float
) -> Blob:
    """Of a mask (h,w) within a box: left, top, width, height."""
    left, top, width, height = box
    x0, y0 = max(left - _ABOUT_PX, 0) & ~1, max(top - _ABOUT_PX, 0) & ~1
    x1 = min(left + width + _ABOUT_PX, before.shape[1]) & ~1
    y1 = min(top + height + _ABOUT_PX, before.shape[0]) & ~1
    here = np.s_[y0:y1, x0:x1]
    has_background = before[here] != UNKNOWN
    return Blob(
        mask[here].astype(np.uint8), has_background, (x0, y0, x1, y1), top, top + height, middle_x
    )


def person_candidates(
    blobs: Mapping[int, Sequence[Blob]],
    cameras: Sequence[Camera],
    image_scales: Sequence[int],
    stature_m: float,
    params: StartParams,
) -> list[PersonCandidate]:
    """Places where people of this stature may stand, best first: one for each blob of the first camera, matched with the
    best blobs of the others."""
    if not blobs or any(not one for one in blobs.values()):
        return []
    first = next(iter(blobs))
    found = [
        best
        for blob in blobs[first]
        if (best := _best_place(first, blob, blobs, cameras, image_scales, stature_m, params))
        is not None
    ]
    return sorted(found, key=lambda one: one.error)


def _best_place(
    first: int,
    blob: Blob,
    blobs: Mapping[int, Sequence[Blob]],
    cameras: Sequence[Camera],
    image_scales: Sequence[int],
    stature_m: float,
    params: StartParams,
) -> PersonCandidate | None:
    camera, scale = cameras[first], image_scales[first]
    pixel = np.array([(blob.middle_x + 0.5) * scale - 0.5, camera.size_px[1] / 2.0])
    ray = rays(camera, pixel)[1].reshape(3)
    ahead = np.array([ray[0], 0.0, ray[2]])
    ahead /= np.linalg.norm(ahead)
    eye = centre(camera) * np.array([1.0, 0.0, 1.0])
    best: PersonCandidate | None = None
    for away_m in np.arange(params.nearest_m, params.farthest_m, params.step_m):
        place = eye + away_m * ahead
        error, mine = 0.0, {}
        for i, some in blobs.items():
            height_px = cameras[i].size_px[1] / image_scales[i]
            ends = project(cameras[i], place + np.array([[0.0, stature_m, 0.0], [0.0, 0.0, 0.0]]))
            top, foot = (ends + 0.5) / image_scales[i] - 0.5
            one = blob if i == first else min(some, key=lambda b: _misfit(b, top, foot, height_px))
            mine[i] = one
            error += _misfit(one, top, foot, height_px)
        if best is None or error < best.error:
            best = PersonCandidate(place, mine, error)
    return best


def _misfit(blob: Blob, top: Floats, foot: Floats, height_px: float) -> float:
    """Mismatch [work px^2] of a blob with a person between top (2,) and foot (2,) [work px]. Feet below the picture cost
    nothing; the lower edge has less weight, since shoes have shadows."""
    across = blob.middle_x - 0.5 * (top[0] + foot[0])
    below = blob.bottom - min(float(foot[1]), height_px)
    return float((blob.top - top[1]) ** 2 + across**2 + 0.5 * below**2)


def is_upright(fitter: Fitter, fit: Fit) -> bool:
    """True if the hips are about as high as in the T-pose and the feet on the floor; excludes people on a television."""
    joints_m = fitter.joints(fit.state)[0]
    return bool(
        joints_m[0, 1] > _UPRIGHT * fitter.model.rest_m[0, 1]
        and joints_m[_ANKLES, 1].mean() < _ON_FLOOR_M
    )


def views_of(person: PersonCandidate, offsets_s: Mapping[int, float]) -> tuple[View, ...]:
    """The candidate's blobs as views of a silhouette fit, but for cameras that are absent now: a search may have begun with
    them. offsets_s: time offsets of those present from the frame set, by index."""
    return tuple(
        View(
            i,
            blob.roi,
            blob.mask,
            np.where(blob.has_background, 255, 0).astype(np.uint8),
            offsets_s[i],
        )
        for i, blob in person.blobs.items()
        if i in offsets_s
    )


def fit_first_pose(
    fitter: Fitter,
    person: PersonCandidate,
    views: Sequence[View],
    factors: Floats,
    information: Floats,
    terms: Sequence[Term],
    params: StartParams,
) -> Generator[None, None, Fit]:
    """The best of several start poses, fitted to the blobs by a silhouette fitter; yields after each fit."""
    rest = fitter.shaper(factors).rest

    def rough_fit(yaw: float, arm: float) -> Fit:
        state = MotionState(
            rest[0] + person.place_m, _stance(yaw, arm), np.zeros(fitter.model.n_pose), factors, information
        )  # fmt: skip
        return fit_to_blobs(fitter, views, state, params.rough_iterations, terms, params)

    directions, sideways = _facing_directions(
        person, [centre(fitter.drawings[i].camera) for i in person.blobs]
    )
    rough_fits: dict[tuple[float, float], Fit] = {}
    for stance in product(directions, params.arms_rad):
        rough_fits[stance] = rough_fit(*stance)
        yield
    _, arm = min(rough_fits, key=lambda stance: rough_fits[stance].cost)
    for yaw in sideways:
        rough_fits[yaw, arm] = rough_fit(yaw, arm)
        yield
    best = sorted(rough_fits.values(), key=lambda fit: fit.cost)
    refined: list[Fit] = []
    for one in best[: params.refined]:
        refined.append(fit_to_blobs(fitter, views, one.state, params.iterations, terms, params))
        yield
    return min(refined, key=lambda fit: fit.cost)


def fit_to_blobs(
    fitter: Fitter,
    views: Sequence[View],
    state: MotionState,
    iterations: int,
    terms: Sequence[Term],
    params: StartParams,
) -> Fit:
    """A silhouette fit to the blobs, starting from this state."""
    return fitter.fit(state, views, params.loose_s, iterations, terms=terms)


def _facing_directions(
    person: PersonCandidate, eyes_m: Sequence[Floats]
) -> tuple[list[float], list[float]]:
    """Facing directions to try [rad], 0 along +Z: towards the cameras, and turned to either side for cameras with nearly
    the same direction; four quarters if cameras stand all around."""
    away = np.array([eye - person.place_m for eye in eyes_m])[:, [0, 2]]
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    middle = away.mean(axis=0)
    yaw = float(np.arctan2(middle[0], middle[1]))
    together = np.linalg.norm(middle)
    if together > _ONE_SIDE:
        return [yaw], [yaw - _PAST_RAD, yaw + _PAST_RAD] if together > _ADJACENT else []
    return [yaw + quarter * 0.5 * np.pi for quarter in range(4)], []


def _stance(yaw: float, arm: float) -> Floats:
    """Local rotations (J,4) of an upright body with arms turned by `arm` [rad] from the T-pose."""
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    local[0] = rotations.exp(np.array([0.0, yaw, 0.0]))
    for side, mirror in (("left", 1.0), ("right", -1.0)):
        local[INDEX[side + "UpperArm"]] = rotations.exp(np.array([0.0, 0.0, mirror * arm]))
    return local
