"""What the room's points, found in two cameras' pictures, say of how the pictures are calibrated.

Points of a room that match must lie on each other's epipolar lines. Where they do not, but would if one camera's pictures
were shifted, scaled, mirrored or turned by 180 degrees, that is what was done with them: of three matches these are
linear equations, and most of the others must agree (RANSAC). Matches that fit some geometry of two cameras but
not the given one contradict it whatever the reason.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from mocapd.geometry.camera_model import centre, normalised
from mocapd.types import Camera, Floats

_OFF = float(np.radians(0.3))  # of a match from its epipolar line
_TRIALS = 400
_SCALES = (0.35, 3.0)  # of pictures that somebody may have made so
_SHIFT = 0.4  # of pictures, in focal lengths: one standard deviation before anything is known
_LEAST_MATCHES = 12
_LEAST, _TIMES = 25, 6.0  # matches that a change explains, and as many times as fit as given
_LEAST_CENTRAL = 20  # of a change of one number
_SHARE = 0.25  # of all matches, that a change explains
_TRIED_SCALES = np.exp(np.linspace(np.log(0.4), np.log(2.5), 185))
_AS_WELL = 0.9  # of the matches that the best change explains: it may be the one as well
# Matches that some geometry of two cameras explains, as a share of all, and of these the share as given
_FREE_LEAST, _FREE_SHARE, _FREE_GIVEN = 50, 0.6, 0.12
_FREE_OFF_PX = 1.5


@dataclass(frozen=True, slots=True)
class PictureChange:
    """cameras: indexes 0 and 1 of those that may be the changed ones; scale: how many times larger what they show is than
    calibrated; is_central: scaled about its middle, and nothing else; count: matches that this explains."""

    cameras: tuple[int, ...]
    scale: float
    is_mirrored: bool
    is_turned: bool
    is_central: bool
    count: int


@dataclass(frozen=True, slots=True)
class RoomVerdict:
    """matches: of points in both pictures; given: of these, how many fit the cameras; free: how many fit some geometry of two
    cameras; change: what explains most of them, None where nothing does or nothing has to."""

    matches: int
    given: int
    free: int
    change: PictureChange | None

    @property
    def is_contradiction(self) -> bool:
        """Whether the matches are surely of one room, and surely not of the cameras as given."""
        return self.change is not None or (
            self.free >= max(_FREE_LEAST, _FREE_SHARE * self.matches)
            and self.given < _FREE_GIVEN * self.free
        )


def judge_room(cameras: tuple[Camera, Camera], px: tuple[Floats, Floats]) -> RoomVerdict:
    """Of two cameras and the points (N,2) [px] that match in what they show at one time."""
    matches = len(px[0])
    if matches < _LEAST_MATCHES:
        return RoomVerdict(matches, 0, 0, None)
    given = _given(cameras, px)
    if given > matches / _TIMES:
        return RoomVerdict(matches, given, given, None)
    free = _fitting_anything(px)
    found = [_best_change(cameras, px, i, flip) for i in (0, 1) for flip in (1.0, -1.0)]
    found += [_best_scale(cameras, px, scaled) for scaled in ((0,), (1,), (0, 1))]
    sure = [one for one in found if _is_sure(one, matches, given)]
    return RoomVerdict(matches, given, free, _likeliest(sure) if sure else None)


def _given(cameras: tuple[Camera, Camera], px: tuple[Floats, Floats]) -> int:
    """Matches on each other's epipolar lines, in either picture, in whatever unit and with whatever axes the rig is."""
    off = []
    for index in (0, 1):
        A, b = epipolar_equations(cameras, px, index)
        off.append(np.abs(A[:, 0] - b))
    return int(np.count_nonzero(np.minimum(*off) < _OFF))


def _is_sure(change: PictureChange, matches: int, given: int) -> bool:
    least = _LEAST_CENTRAL if change.is_central else _LEAST
    return change.count >= max(least, _TIMES * (given + 1), _SHARE * matches)


def _likeliest(found: Sequence[PictureChange]) -> PictureChange | None:
    """The change with most matches, of those near it the simplest; it names all cameras of which one may be changed so."""
    most = max(one.count for one in found)
    near = [one for one in found if one.count >= _AS_WELL * most]
    plain = [one for one in near if not one.is_mirrored and not one.is_turned] or near
    best = max(plain, key=lambda one: (one.is_central, one.count))
    alike = {
        i
        for one in plain
        if one.is_mirrored == best.is_mirrored and one.is_turned == best.is_turned
        for i in one.cameras
    }
    return replace(best, cameras=tuple(sorted(alike)))


def _best_change(
    cameras: tuple[Camera, Camera], px: tuple[Floats, Floats], index: int, flip: float
) -> PictureChange:
    """By RANSAC, how pictures of the one camera, mirrored first where flip is -1, have to be scaled and shifted."""
    A, b = epipolar_equations(cameras, px, index, flip)
    rng = np.random.default_rng(0)
    ids = rng.integers(0, len(A), (_TRIALS, 3))
    solved = _solved(A[ids], b[ids])
    inside = _agree(A, b, solved)
    best = solved[int(inside.sum(axis=1).argmax())]
    for _ in range(3):
        use = _agree(A, b, best[None])[0]
        if use.sum() < 3:
            break
        best = _solved(A[use][None], b[use][None])[0]
    count = int(_agree(A, b, best[None]).sum())
    scale = float(best[0])
    return PictureChange(
        (index,), 1.0 / max(abs(scale), 1e-6), flip < 0.0, scale < 0.0, False, count
    )


def _best_scale(
    cameras: tuple[Camera, Camera], px: tuple[Floats, Floats], scaled: tuple[int, ...]
) -> PictureChange:
    """By how much the pictures of one camera, or of both alike, were made larger about their middles."""
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
    """A (N,3), b (N,): A (s, x, y) = b holds for matches (N,2) [px] if what the one camera shows, mirrored where flip is -1,
    has to be scaled by s about its principal point and shifted by x, y [focal lengths]. Residuals are angles [rad]."""
    mine, other = cameras[index], cameras[1 - index]
    xy = normalised(other, px[1 - index])
    ray = np.concatenate([xy, np.ones((len(xy), 1))], axis=1) @ other.R
    normal = np.cross(np.broadcast_to(centre(other) - centre(mine), ray.shape), ray)
    lines = normal @ mine.R.T
    lines /= np.maximum(np.linalg.norm(lines, axis=1, keepdims=True), 1e-12)
    shown = normalised(mine, px[index]) * np.array([flip, 1.0])
    along = (lines[:, :2] * shown).sum(axis=1, keepdims=True)
    return np.concatenate([along, lines[:, :2]], axis=1), -lines[:, 2]


def _solved(A: Floats, b: Floats) -> Floats:
    """(T,3) scale and shift of T times M equations (T,M,3), (T,M); what they leave open is near no shift."""
    prior = np.diag([0.0, 1.0, 1.0]) * (_OFF / _SHIFT) ** 2
    normal = np.einsum("tmi,tmj->tij", A, A) + prior + 1e-12 * np.eye(3)
    right = np.einsum("tmi,tm->ti", A, b)
    return np.asarray(np.linalg.solve(normal, right[..., None])[..., 0])


def _agree(A: Floats, b: Floats, solved: Floats) -> np.ndarray:
    """(T,N): matches that agree with each solution, by how far off they are in the picture as it is shown."""
    scale = np.abs(solved[:, :1])
    off = np.abs(solved @ A.T - b) / np.maximum(scale, 1e-9)
    low, high = 1.0 / _SCALES[1], 1.0 / _SCALES[0]
    return np.asarray((off < _OFF) & (scale > low) & (scale < high))


def _fitting_anything(px: tuple[Floats, Floats]) -> int:
    """How many matches one fundamental matrix explains."""
    _, mask = cv2.findFundamentalMat(px[0], px[1], cv2.USAC_MAGSAC, _FREE_OFF_PX, 0.999, 5000)
    # None where nothing fits, whatever OpenCV's stubs say
    return int(np.count_nonzero(np.asarray(mask) == 1))
