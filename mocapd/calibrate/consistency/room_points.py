"""Checks the calibration of two cameras' pictures by matching points of the room.

Matching points must lie on each other's epipolar lines. Where they do not, but would after shifting, scaling, mirroring or
rotating one camera's pictures by 180 degrees, that is the mistake. For three matches these are linear equations, and most
of the other matches must agree (RANSAC). Matches that fit some fundamental matrix but not the given cameras contradict
them, whatever the reason.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from mocapd.geometry.camera_model import centre, normalised
from mocapd.types import Camera, Floats

_OFF = float(np.radians(0.3))  # of a match from its epipolar line
_TRIALS = 400
_SCALES = (0.35, 3.0)  # of pictures after a user's edit
_SHIFT = 0.4  # prior of the shift of pictures, in focal lengths, one standard deviation
_LEAST_MATCHES = 12
# least matches that a change explains, and least ratio to the matches as given
_LEAST, _TIMES = 25, 6.0
_LEAST_CENTRAL = 20  # of a change with one parameter
_SHARE = 0.25  # least share of all matches that a change explains
_TRIED_SCALES = np.exp(np.linspace(np.log(0.4), np.log(2.5), 185))
_AS_WELL = 0.9  # of the matches that the best change explains: it may be the one as well
# Least count and share of matches that some geometry of two cameras explains, and largest share of these as given
_FREE_LEAST, _FREE_SHARE, _FREE_GIVEN = 50, 0.6, 0.12
_FREE_OFF_PX = 1.5


@dataclass(frozen=True, slots=True)
class PictureChange:
    """cameras: indexes 0 and 1 of those that may be the changed ones; scale: enlargement of their view relative to the
    calibration; is_central: scaled about its middle, and nothing else; count: matches that this explains."""

    cameras: tuple[int, ...]
    scale: float
    is_mirrored: bool
    is_turned: bool
    is_central: bool
    count: int


@dataclass(frozen=True, slots=True)
class RoomVerdict:
    """matches: points in both pictures; given: how many of them fit the cameras; free: how many fit some geometry of two
    cameras; change: the one that explains most of them, None where none does or none is needed."""

    matches: int
    given: int
    free: int
    change: PictureChange | None

    @property
    def is_contradiction(self) -> bool:
        """Whether the matches are certainly of one room, and certainly not of the cameras as given."""
        return self.change is not None or (
            self.free >= max(_FREE_LEAST, _FREE_SHARE * self.matches)
            and self.given < _FREE_GIVEN * self.free
        )


def judge_room(cameras: tuple[Camera, Camera], px: tuple[Floats, Floats]) -> RoomVerdict:
    """Judge two cameras by the points (N,2) [px] that match in simultaneous pictures."""
    matches = len(px[0])
    if matches < _LEAST_MATCHES:
        return RoomVerdict(matches, 0, 0, None)
    given = _count_given(cameras, px)
    if given > matches / _TIMES:
        return RoomVerdict(matches, given, given, None)
    free = _fitting_anything(px)
    changes = [_best_change(cameras, px, i, flip) for i in (0, 1) for flip in (1.0, -1.0)]
    changes += [_best_scale(cameras, px, scaled) for scaled in ((0,), (1,), (0, 1))]
    sure = [change for change in changes if _is_sure(change, matches, given)]
    return RoomVerdict(matches, given, free, _likeliest(sure) if sure else None)


def _count_given(cameras: tuple[Camera, Camera], px: tuple[Floats, Floats]) -> int:
    """The number of matches on each other's epipolar lines, in either picture, for any units and axes of the rig."""
    off = []
    for index in (0, 1):
        A, b = epipolar_equations(cameras, px, index)
        off.append(np.abs(A[:, 0] - b))
    return int(np.count_nonzero(np.minimum(*off) < _OFF))


def _is_sure(change: PictureChange, matches: int, given: int) -> bool:
    least = _LEAST_CENTRAL if change.is_central else _LEAST
    return change.count >= max(least, _TIMES * (given + 1), _SHARE * matches)


def _likeliest(changes: Sequence[PictureChange]) -> PictureChange | None:
    """The change with most matches, of those near it the simplest; names all cameras that may have it."""
    most = max(change.count for change in changes)
    near = [change for change in changes if change.count >= _AS_WELL * most]
    plain = [change for change in near if not change.is_mirrored and not change.is_turned] or near
    best = max(plain, key=lambda change: (change.is_central, change.count))
    alike = {
        i
        for change in plain
        if change.is_mirrored == best.is_mirrored and change.is_turned == best.is_turned
        for i in change.cameras
    }
    return replace(best, cameras=tuple(sorted(alike)))


def _best_change(
    cameras: tuple[Camera, Camera], px: tuple[Floats, Floats], index: int, flip: float
) -> PictureChange:
    """RANSAC for the scale and shift of one camera's pictures, mirrored first where flip is -1."""
    A, b = epipolar_equations(cameras, px, index, flip)
    rng = np.random.default_rng(0)
    ids = rng.integers(0, len(A), (_TRIALS, 3))
    solved = _solve_linear(A[ids], b[ids])
    inside = _agree(A, b, solved)
    best = solved[int(inside.sum(axis=1).argmax())]
    for _ in range(3):
        use = _agree(A, b, best[None])[0]
        if use.sum() < 3:
            break
        best = _solve_linear(A[use][None], b[use][None])[0]
    count = int(_agree(A, b, best[None]).sum())
    scale = float(best[0])
    return PictureChange(
        (index,), 1.0 / max(abs(scale), 1e-6), flip < 0.0, scale < 0.0, False, count
    )


def _best_scale(
    cameras: tuple[Camera, Camera], px: tuple[Floats, Floats], scaled: tuple[int, ...]
) -> PictureChange:
    """The enlargement about their middles of the pictures of one camera, or of both alike."""
    xy = [normalised(camera, at) for camera, at in zip(cameras, px, strict=True)]
    apart = centre(cameras[1]) - centre(cameras[0])
    counts = []
    for scale in _TRIED_SCALES:
        ray = [
            np.concatenate([at / (scale if i in scaled else 1.0), np.ones((len(at), 1))], axis=1)
            @ camera.R
            for i, (camera, at) in enumerate(zip(cameras, xy, strict=True))
        ]
        normal = np.cross(np.broadcast_to(apart, ray[0].shape), ray[0])
        size = np.linalg.norm(normal, axis=1) * np.linalg.norm(ray[1], axis=1)
        off = np.abs((normal * ray[1]).sum(axis=1)) / np.maximum(size, 1e-12)
        counts.append(int((off < _OFF / max(scale, 1.0)).sum()))
    k = int(np.argmax(counts))
    return PictureChange(scaled, float(_TRIED_SCALES[k]), False, False, True, counts[k])


def epipolar_equations(
    cameras: tuple[Camera, Camera], px: tuple[Floats, Floats], index: int, flip: float = 1.0
) -> tuple[Floats, Floats]:
    """A (N,3), b (N,): A (s, x, y) = b holds for matches (N,2) [px] if the one camera's picture, mirrored where flip is -1,
    needs scaling by s about its principal point and a shift by x, y [focal lengths]. Residuals are angles [rad]."""
    mine, other = cameras[index], cameras[1 - index]
    xy = normalised(other, px[1 - index])
    ray = np.concatenate([xy, np.ones((len(xy), 1))], axis=1) @ other.R
    normal = np.cross(np.broadcast_to(centre(other) - centre(mine), ray.shape), ray)
    lines = normal @ mine.R.T
    lines /= np.maximum(np.linalg.norm(lines, axis=1, keepdims=True), 1e-12)
    shown = normalised(mine, px[index]) * np.array([flip, 1.0])
    along = (lines[:, :2] * shown).sum(axis=1, keepdims=True)
    return np.concatenate([along, lines[:, :2]], axis=1), -lines[:, 2]


def _solve_linear(A: Floats, b: Floats) -> Floats:
    """(T,3) scale and shift of T times M equations (T,M,3), (T,M), regularised towards no shift."""
    prior = np.diag([0.0, 1.0, 1.0]) * (_OFF / _SHIFT) ** 2
    normal = np.einsum("tmi,tmj->tij", A, A) + prior + 1e-12 * np.eye(3)
    right = np.einsum("tmi,tm->ti", A, b)
    return np.asarray(np.linalg.solve(normal, right[..., None])[..., 0])


def _agree(A: Floats, b: Floats, solved: Floats) -> np.ndarray:
    """(T,N): inliers of each solution, by their distance in the picture."""
    scale = np.abs(solved[:, :1])
    off = np.abs(solved @ A.T - b) / np.maximum(scale, 1e-9)
    low, high = 1.0 / _SCALES[1], 1.0 / _SCALES[0]
    return np.asarray((off < _OFF) & (scale > low) & (scale < high))


def _fitting_anything(px: tuple[Floats, Floats]) -> int:
    """The number of inliers of a fundamental matrix (RANSAC)."""
    _, mask = cv2.findFundamentalMat(px[0], px[1], cv2.USAC_MAGSAC, _FREE_OFF_PX, 0.999, 5000)
    # None without a solution, which OpenCV's stubs do not say
    return int(np.count_nonzero(np.asarray(mask) == 1))
