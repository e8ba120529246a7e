"""Fixed points of the room in one camera's pictures, and the camera rotation that moved them.

Corners of a small picture (Shi and Tomasi 1994) are tracked to a later one (pyramidal Lucas-Kanade, forward and
backward). Points on a person move in all directions; points that a camera rotation moved agree on that rotation. RANSAC
over pairs of points finds it, and Kabsch's method solves it from all inliers.
"""

from collections import Counter
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from mocapd.geometry import rotations
from mocapd.geometry.camera_model import normalised
from mocapd.geometry.rigid_transforms import align_directions
from mocapd.types import Bytes, Camera, Floats, Singles

_WIDTH_PX = 160  # of the small pictures: a turn of one degree is over two of their pixels
_APART_PX, _QUALITY = 6.0, 0.02
_CELL_PX, _IN_A_CELL = 40, 8
_SHADE_PX, _NOISE = 6.0, 4.0  # radius of the local contrast normalisation, and its noise floor
_WINDOW_PX, _LEVELS = 11, 3
_BACK_PX = 0.5  # largest forward-backward error
_AGREE_PX = 0.7
_TRIES, _ROUNDS = 64, 3


@dataclass(frozen=True, slots=True, eq=False)
class Landmarks:
    """A small picture (h,w), and the marks in it: places (N,2) [px] and rays (N,3)."""

    picture: Bytes
    places: Singles
    rays: Floats


@dataclass(frozen=True, slots=True, eq=False)
class CameraTurn:
    """The camera's rotation since the marks were made: rotation vector (3,) [rad], from rays before to
    rays now; `agree`: the number of inliers."""

    turn_rad: Floats
    agree: int


def find_landmarks(pixels: Bytes, camera: Camera) -> Landmarks:
    """The marks of a picture (height,width,3) BGR, perhaps none."""
    picture = _small(pixels)
    # None for no corner, which OpenCV's stubs do not say
    corners: Any = cv2.goodFeaturesToTrack(picture, 0, _QUALITY, _APART_PX, blockSize=5)
    places = np.asarray([] if corners is None else corners, dtype=np.float32).reshape(-1, 2)
    places = _spread(places)
    return Landmarks(picture, places, _rays(picture, places, camera))


def landmarks_at(picture: Bytes, places: Singles, camera: Camera) -> Landmarks:
    """Marks from stored positions, which lack the rays."""
    return Landmarks(picture, places, _rays(picture, places, camera))


def measure_turn(marks: Landmarks, pixels: Bytes, camera: Camera) -> CameraTurn:
    """The camera's rotation in a later picture. No rotation wins over another one unless twice as many marks
    support that."""
    before, now = _track(marks, _small(pixels), camera)
    focal_px = float(camera.K[0, 0]) * _WIDTH_PX / camera.size_px[0]
    limit = _AGREE_PX / focal_px
    if len(before) < 2:
        return CameraTurn(np.zeros(3), 0)
    still = _agreeing(np.eye(3), before, now, limit)
    R, agree = _best_rotation(before, now, limit)
    if 2 * still.sum() >= agree.sum():
        R, agree = np.eye(3), still
    for _ in range(_ROUNDS):
        if agree.sum() < 3:
            break
        R = align_directions(now[agree], before[agree])
        agree = _agreeing(R, before, now, limit)
    turn: Floats = rotations.log(rotations.from_matrix(R))
    return CameraTurn(turn, int(agree.sum()))


def _spread(places: Singles) -> Singles:
    """The first mark of each cell: a person in a gaudy shirt must not have all the marks."""
    spread, held = [], Counter[tuple[int, int]]()
    for place in places:
        cell = (int(place[0]) // _CELL_PX, int(place[1]) // _CELL_PX)
        held[cell] += 1
        if held[cell] <= _IN_A_CELL:
            spread.append(place)
    return np.asarray(spread, dtype=np.float32).reshape(-1, 2)


def _small(pixels: Bytes) -> Bytes:
    """A small grey picture with normalised local contrast."""
    h, w = pixels.shape[:2]
    small = cv2.resize(pixels, (_WIDTH_PX, h * _WIDTH_PX // w), interpolation=cv2.INTER_AREA)
    grey = cv2.GaussianBlur(cv2.cvtColor(small, cv2.COLOR_BGR2GRAY).astype(np.float32), (0, 0), 0.8)
    detail = grey - cv2.GaussianBlur(grey, (0, 0), _SHADE_PX)
    contrast = np.sqrt(cv2.GaussianBlur(detail * detail, (0, 0), _SHADE_PX)) + _NOISE
    return np.clip(128.0 + 48.0 * detail / contrast, 0, 255).astype(np.uint8)


def _track(marks: Landmarks, picture: Bytes, camera: Camera) -> tuple[Floats, Floats]:
    """Rays (M,3) of the tracked marks, before and now."""
    if len(marks.places) == 0 or picture.shape != marks.picture.shape:
        return np.empty((0, 3)), np.empty((0, 3))
    there, is_tracked = _flow(marks.picture, picture, marks.places)
    back, again = _flow(picture, marks.picture, there)
    same = is_tracked & again & (np.abs(back - marks.places).max(axis=1) < _BACK_PX)
    return marks.rays[same], _rays(picture, there[same], camera)


def _flow(a: Bytes, b: Bytes, places: Singles) -> tuple[Singles, NDArray[np.bool_]]:
    """Positions in picture b of places (N,2) of picture a, and which of them were tracked."""
    there, is_tracked, _ = cv2.calcOpticalFlowPyrLK(
        a, b, places, np.empty_like(places),
        winSize=(_WINDOW_PX, _WINDOW_PX), maxLevel=_LEVELS, minEigThreshold=1e-3,
    )  # fmt: skip
    return np.asarray(there, dtype=np.float32), np.asarray(is_tracked).ravel() > 0


def _rays(picture: Bytes, places: Singles, camera: Camera) -> Floats:
    """Unit vectors (N,3) in the camera's frame through places (N,2) of its small picture (h,w)."""
    scale = np.array(camera.size_px) / picture.shape[::-1]
    xy = normalised(camera, (places.astype(np.float64) + 0.5) * scale - 0.5).reshape(-1, 2)
    rays = np.column_stack([xy, np.ones(len(xy))])
    out: Floats = rays / np.linalg.norm(rays, axis=1, keepdims=True)
    return out


def _agreeing(R: Floats, before: Floats, now: Floats, limit: float) -> NDArray[np.bool_]:
    """Inliers of each rotation (...,3,3) among the rays: (...,M)."""
    missed = np.einsum("...ij,mj->...mi", R, before) - now
    out: NDArray[np.bool_] = (missed**2).sum(axis=-1) < limit**2
    return out


def _best_rotation(before: Floats, now: Floats, limit: float) -> tuple[Floats, NDArray[np.bool_]]:
    """RANSAC: of rotations that each fit one pair of rays, the one with the most inliers."""
    first, second = np.random.default_rng(0).integers(0, len(before), (2, _TRIES))
    F, G = _triad(before[first], before[second]), _triad(now[first], now[second])
    R = G @ np.swapaxes(F, 1, 2)
    agree = _agreeing(R, before, now, limit)
    best = int(agree.sum(axis=1).argmax())
    return R[best], agree[best]


def _triad(a: Floats, b: Floats) -> Floats:
    """Orthonormal columns (S,3,3) from pairs of directions (S,3)."""
    c = np.cross(a, b)
    c /= np.maximum(np.linalg.norm(c, axis=1, keepdims=True), 1e-9)
    return np.stack([a, c, np.cross(a, c)], axis=2)
