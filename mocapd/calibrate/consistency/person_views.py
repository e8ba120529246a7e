"""Finds the joints of people in one camera's pictures, without any calibration.

The heatmap network needs a crop around a person. Candidates are foreground or moving regions; the crop then follows
the joints. Rotated pictures are rotated upright first: the orientation of a person is a result, not an assumption.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from mocapd.types import Bytes, Floats, Ints
from mocapd.vision.clip_background import clip_background
from mocapd.vision.heatmaps.joint_network import (
    BODY_JOINTS,
    CELLS,
    INPUT_PX,
    MIDDLE,
    SIDE_M,
    STATURE_M,
    DetectedJoints,
    JointNetwork,
)

WORK_PX = 320  # the longer side of the pictures
_HIPS, _NECK = BODY_JOINTS.index("hips"), BODY_JOINTS.index("neck")
_TORSO_M = 0.50  # from hips to neck, of a person 1.75 m tall
_ROOM_PICTURES = 24
_CELL_PX = INPUT_PX / CELLS
_GREY = (127.5, 127.5, 127.5)
_SAME_LIGHT = 0.15  # of the logarithm of a picture's mean
_DIFFERS = 28.0  # of a channel, 0..255
_HEIGHT_SHARES = (0.5, 0.9, 1.5, 2.4)  # of a candidate's height, for the crop
_LOOSE_CELLS = 2.6  # a median spread above which a person counts as lost
_SURE_CELLS = 1.5  # spread of a joint that counts
_SIDES_PX = 30.0, 900.0  # of a crop
_MIDDLE_DOWN = 0.33  # position of the crop's middle along a person
_LOST_PICTURES = 3
_TURN_GAIN = 0.85  # of the spread upright, which a rotated picture must have: people rarely stand on their heads


@dataclass(frozen=True, slots=True, eq=False)
class WorkPictures:
    """One camera's pictures (F,h,w,3) at times_s (F,) [s], `smaller` times smaller than the camera's."""

    times_s: Floats
    pictures: Bytes
    smaller: float


@dataclass(frozen=True, slots=True, eq=False)
class ViewedRoom:
    """A camera's empty room (h,w,3), and where its pixels are valid (h,w), 0 or 1."""

    picture: Bytes
    valid: Bytes

    def rotate_left(self, turns: int) -> "ViewedRoom":
        """Rotated left by so many quarters."""
        return ViewedRoom(_rotate_picture(self.picture, turns), _rotate_picture(self.valid, turns))


@dataclass(frozen=True, slots=True, eq=False)
class _Start:
    """The first crop of a track of a person, in a rotated picture."""

    frame: int
    turns: int
    spread: float
    side: float
    middle: Floats


@dataclass(frozen=True, slots=True, eq=False)
class PersonView:
    """One person in F pictures of a camera.

    times_s (F,) [s]; px (F,J,2): joints of `BODY_JOINTS` in the camera's full pictures; spread (F,J) of their maps [cells];
    farther_m (F,J): depth beyond the hips, as the network estimates it from one picture. quarter_turns: rotations of
    the picture to the left by 90 degrees until the person stands upright.
    """

    times_s: Floats
    px: Floats
    spread: Floats
    farther_m: Floats
    quarter_turns: int

    @property
    def sure(self) -> np.ndarray:
        """(F,J): reliable joints."""
        return self.spread < _SURE_CELLS


def shrink(picture: Bytes) -> tuple[Bytes, float]:
    """A picture (h,w,3) with WORK_PX at its longer side, and the factor of its reduction."""
    h, w = picture.shape[:2]
    smaller = max(1.0, max(h, w) / WORK_PX)
    size = (max(1, round(w / smaller)), max(1, round(h / smaller)))
    small = cv2.resize(picture, size, interpolation=cv2.INTER_AREA)
    return np.asarray(small, np.uint8), smaller


class PersonFinder:
    """Finds people in pictures; has the network's buffers, so one thread only."""

    def __init__(self, breathe: Callable[[], object] = bool) -> None:
        """breathe: called before each look of the network, which takes a few milliseconds."""
        self._network, self._breathe = JointNetwork(), breathe

    def people(
        self, work: WorkPictures, room: ViewedRoom, most: int, turns: Sequence[int]
    ) -> list[PersonView]:
        """At most so many people in a few seconds of pictures, the likeliest first; `turns`: quarter turns to try."""
        lit = _relit(room, work.pictures[len(work.pictures) // 2])
        out = []
        for box in candidates(work, lit)[:most]:
            view = self._follow(work, lit, box, turns)
            if view is not None:
                out.append(view)
        return out

    def _follow(
        self, work: WorkPictures, room: ViewedRoom, box: Ints, turns: Sequence[int]
    ) -> PersonView | None:
        count, joints = len(work.pictures), len(BODY_JOINTS)
        best = min(
            (self._begin(work, room, box, turn) for turn in turns), key=lambda start: start.spread
        )
        if best.spread > _LOOSE_CELLS:
            return None
        back = room.rotate_left(best.turns)
        px, farther = np.full((count, joints, 2), np.nan), np.full((count, joints), np.nan)
        spread = np.full((count, joints), np.inf)
        for order in (range(best.frame, count), range(best.frame - 1, -1, -1)):
            side, middle, lost = best.side, best.middle, 0
            for f in order:
                at, detection = self._look(
                    _rotate_picture(work.pictures[f], best.turns), back, side, middle
                )
                spread[f], farther[f], px[f] = _spread(detection), detection.farther_m, at
                lost = lost + 1 if np.median(spread[f]) > _LOOSE_CELLS else 0
                if lost > _LOST_PICTURES:
                    break
                side, middle = _next_crop(at, side)
        there = np.isfinite(px[:, 0, 0])
        px = _rotate_px_back(px[there], work.pictures.shape[2:0:-1], best.turns)
        full_px = (px + 0.5) * work.smaller - 0.5
        return PersonView(work.times_s[there], full_px, spread[there], farther[there], best.turns)

    def _begin(self, work: WorkPictures, room: ViewedRoom, box: Ints, turns: int) -> _Start:
        """The best crop in the rotated picture of a box."""
        frame = int(box[0])
        picture, back = _rotate_picture(work.pictures[frame], turns), room.rotate_left(turns)
        corners = np.array([box[1:3], box[1:3] + box[3:5]], np.float64)
        corners = _rotate_px(corners, work.pictures.shape[2:0:-1], turns)
        low, high = corners.min(axis=0), corners.max(axis=0)
        tall = float(high[1] - low[1])
        best = _Start(frame, turns, np.inf, 1.0, low)
        for share in _HEIGHT_SHARES:
            side = float(np.clip(share * tall * SIDE_M / STATURE_M, *_SIDES_PX))
            middle = np.array(
                [(low[0] + high[0]) / 2, low[1] + _MIDDLE_DOWN * min(share, 1.0) * tall]
            )
            at, detection = self._look(picture, back, side, middle)
            for _ in range(2):
                side, middle = _next_crop(at, side)
                at, detection = self._look(picture, back, side, middle)
            spread = float(np.median(_spread(detection)))
            if spread < best.spread:
                best = _Start(frame, turns, spread, side, middle)
        if turns:
            best = replace(best, spread=best.spread / _TURN_GAIN)
        return best

    def _look(
        self, picture: Bytes, room: ViewedRoom, side: float, middle: Floats
    ) -> tuple[Floats, DetectedJoints]:
        """Joints (J,2) in a picture's pixels, in the crop of this side about this middle."""
        self._breathe()
        scale = INPUT_PX / side
        corner = INPUT_PX / 2 - 0.5 - scale * middle
        M = np.array([[scale, 0.0, corner[0]], [0.0, scale, corner[1]]])
        size = (INPUT_PX, INPUT_PX)
        small = cv2.warpAffine(picture, M, size, flags=cv2.INTER_LINEAR, borderValue=_GREY)
        back = cv2.warpAffine(room.picture, M, size, flags=cv2.INTER_LINEAR, borderValue=_GREY)
        there = cv2.warpAffine(room.valid, M, size, flags=cv2.INTER_NEAREST, borderValue=(0,))
        detection = self._network.detect(
            np.asarray(small, np.uint8), np.asarray(back, np.float32), np.asarray(there, np.uint8)
        ).of_body
        crop_px = detection.at_cells * _CELL_PX + (_CELL_PX / 2 - 0.5)
        return (crop_px - corner) / scale, detection


def room_of(work: WorkPictures) -> ViewedRoom:
    """The background of a camera, from pictures spread over the recording."""
    ids = np.unique(np.linspace(0, len(work.pictures) - 1, _ROOM_PICTURES).astype(int))
    room, valid = clip_background([work.pictures[i] for i in ids], work.times_s[ids])
    return ViewedRoom(room, valid.astype(np.uint8))


class RoomsByLight:
    """A camera's background per light level: pictures before and after a lamp went out have two backgrounds."""

    def __init__(self, work: WorkPictures) -> None:
        self._work = work
        self._light = np.log([float(picture[::4, ::4].mean()) + 4.0 for picture in work.pictures])
        self._rooms: dict[int, ViewedRoom] = {}

    def during(self, part: WorkPictures) -> ViewedRoom:
        """The background in the light of a few seconds of the same pictures."""
        light = float(
            np.median(np.log([float(picture[::4, ::4].mean()) + 4.0 for picture in part.pictures]))
        )
        alike = np.abs(self._light - light) < _SAME_LIGHT
        if alike.sum() < _ROOM_PICTURES:
            alike[:] = True
        key = int(np.flatnonzero(alike)[0]) * len(alike) + int(alike.sum())
        if key not in self._rooms:
            work = self._work
            self._rooms[key] = room_of(
                WorkPictures(work.times_s[alike], work.pictures[alike], work.smaller)
            )
        return self._rooms[key]


def candidates(work: WorkPictures, room: ViewedRoom) -> list[Ints]:
    """Boxes (5,) = picture, x, y, width, height of possible people, the likeliest first."""
    count = len(work.pictures)
    out: list[tuple[float, Ints]] = []
    for share in (0.5, 0.8, 0.25):
        f = min(count - 1, int(share * count))
        differs = _differs(work.pictures[f], room)
        near = work.pictures[max(0, f - 8) : f + 9 : 2].astype(np.int16)
        moves = (np.ptp(near, axis=0).max(axis=-1) > 2 * _DIFFERS).astype(np.uint8)
        for mask, worth in ((differs, 1.0), (moves, 0.8)):
            out += [(worth * area, np.array([f, *box])) for area, box in _pieces(mask)]
    out.sort(key=lambda candidate: -candidate[0])
    distinct: list[Ints] = []
    for _, box in out:
        if all(_overlap(box, other) < 0.3 for other in distinct):
            distinct.append(box)
    return distinct


def _differs(picture: Bytes, room: ViewedRoom) -> Bytes:
    """Foreground mask (h,w) of a picture."""
    off = np.asarray(cv2.absdiff(picture, room.picture)).max(axis=-1)
    return np.asarray((off > _DIFFERS) | (room.valid == 0), np.uint8)


def _relit(room: ViewedRoom, picture: Bytes) -> ViewedRoom:
    """The background with the brightness of a picture: a lamp changes all of it."""
    now, then = picture.astype(np.float32) + 8.0, room.picture.astype(np.float32) + 8.0
    gain = np.median(now / then, axis=(0, 1))
    return ViewedRoom(np.clip(then * gain - 8.0, 0, 255).astype(np.uint8), room.valid)


def _pieces(mask: Bytes) -> list[tuple[float, Ints]]:
    """Areas and boxes x, y, w, h of the large connected components of a mask."""
    mask = np.asarray(cv2.morphologyEx(mask, cv2.MORPH_OPEN, np.ones((3, 3), np.uint8)), np.uint8)
    mask = np.asarray(cv2.morphologyEx(mask, cv2.MORPH_CLOSE, np.ones((11, 7), np.uint8)), np.uint8)
    _, _, stats, _ = cv2.connectedComponentsWithStats(mask)
    least = 0.004 * mask.size
    return [(float(row[4]), np.asarray(row[:4])) for row in stats[1:] if row[4] > least]


def _overlap(a: Ints, b: Ints) -> float:
    """Intersection of two boxes over the area of the smaller, regardless of their time."""
    w = min(a[1] + a[3], b[1] + b[3]) - max(a[1], b[1])
    h = min(a[2] + a[4], b[2] + b[4]) - max(a[2], b[2])
    return max(0.0, float(w)) * max(0.0, float(h)) / float(min(a[3] * a[4], b[3] * b[4]))


def _rotate_picture(picture: Bytes, turns: int) -> Bytes:
    return np.ascontiguousarray(np.rot90(picture, turns, (0, 1))) if turns else picture


def _spread(detection: DetectedJoints) -> Floats:
    """Spread of each joint's map (J,) [cells]."""
    return np.sqrt(detection.spread_cells2[:, 0] + detection.spread_cells2[:, 2])


def _next_crop(at: Floats, side: float) -> tuple[float, Floats]:
    """Side and middle of the next crop about joints (J,2)."""
    hips, neck = at[_HIPS], at[_NECK]
    wanted = float(np.hypot(*(neck - hips))) / _TORSO_M * SIDE_M
    # a bent trunk looks short
    side = 0.7 * side + 0.3 * float(np.clip(wanted, 0.75 * side, 1.3 * side))
    return float(np.clip(side, *_SIDES_PX)), hips + MIDDLE * (neck - hips)


def _rotate_px(px: Floats, size: tuple[int, int], turns: int) -> Floats:
    """Pixels (...,2) of a picture of this size (w, h) after its rotation to the left."""
    w, h = size
    x, y = px[..., 0], px[..., 1]
    to = [(x, y), (y, w - 1 - x), (w - 1 - x, h - 1 - y), (h - 1 - y, x)][turns % 4]
    return np.stack(to, axis=-1)


def _rotate_px_back(px: Floats, size: tuple[int, int], turns: int) -> Floats:
    """The inverse of `_rotate_px`; the size is of the picture before the rotation."""
    return _rotate_px(px, size[::-1] if turns % 2 else size, -turns)
