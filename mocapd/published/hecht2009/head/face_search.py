"""Searches whole pictures for faces, a part of one picture in each step, and tests them for liveness.

A face on a poster does not change: the test is whether the picture there has changed over the last seconds. A face of
the wrong true size is rejected too, still or moving; this needs two cameras.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import cv2
import numpy as np

from mocapd.body.head_proportions import FACE_WIDTH
from mocapd.published.hecht2009.face.face_detection import (
    STEP,
    FaceBox,
    face_sizes,
    face_windows,
    faces_near,
    group_windows,
)
from mocapd.published.hecht2009.face.lbp_cascade_kernels import WINDOW_PX, CascadeArrays
from mocapd.published.hecht2009.head.face_placing import PlacedFace, fits_swapped, placed_face
from mocapd.published.hecht2009.head.head_params import (
    FARTHEST_M,
    LEAST_WINDOWS,
    NEAREST_M,
)
from mocapd.published.hecht2009.head.head_views import HeadView
from mocapd.types import Bytes

_CANDIDATES, _CANDIDATE_S = 3, 0.6  # how many faces are kept, for how long after a detection
_WINDOWS = 36_000  # classified in one step: 4 ms
_LEAST_PX = 21.0  # of a face, with the picture enlarged a little
_LOOKS = 4  # places of one step that are searched closely
_REACH = 0.45  # of the side: how far a face moves from one step to the next
_PAST_S = 0.25  # between stored pictures
_PASTS = 10
_OLD_S = 0.3  # before a picture counts as past
_SMALL = 4  # reduction factor of stored pictures
_AROUND = 1.6  # of the box's side: head and hair
_STILL = 0.012  # loss of correlation of a place where nothing but noise changes
# faces that fit only crosswise, for each that fits, before the cameras count as swapped
_SWAPPED_LOOKS = 3


@dataclass(frozen=True, slots=True, eq=False)
class FaceCandidate:
    """A face in one view (camera index); unseen_s: time since its last detection; looks: number of detections. alive: its
    picture has changed, None: too early. placed: its position as of `placed_s` ago; None: not yet."""

    view: int
    box: FaceBox
    unseen_s: float
    looks: int
    alive: bool | None
    placed: PlacedFace | None = None
    placed_s: float = float(np.inf)


class FaceSearch:
    """State of the search: the face candidates, the scan position, and earlier pictures."""

    def __init__(self, cascade: CascadeArrays, stature_m: float) -> None:
        self._cascade, self._stature_m = cascade, stature_m
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        self.candidates: list[FaceCandidate] = []
        self._straight = self._crossed = 0
        self._turn = 0
        self._work: list[tuple[float, tuple[int, int, int, int]]] = []
        self._past: list[tuple[float, dict[int, Bytes]]] = []
        self._time_s = 0.0

    @property
    def are_swapped(self) -> bool:
        """True if two cameras seem to be swapped."""
        return self._crossed >= max(_SWAPPED_LOOKS, 3 * self._straight)

    def remember(self, views: Sequence[HeadView], dt_s: float) -> None:
        """Store the pictures for comparison with later ones."""
        self._time_s += dt_s
        if self._past and self._time_s - self._past[-1][0] < _PAST_S:
            return
        self._past.append((self._time_s, {v.index: _downscale(v.grey) for v in views}))
        del self._past[:-_PASTS]

    def step(self, views: Sequence[HeadView], dt_s: float) -> None:
        """Track the candidates and search for further faces; call `remember` before."""
        by_index = {view.index: view for view in views}
        followed = [self._follow(c, by_index.get(c.view), dt_s) for c in self.candidates]
        self.candidates = [c for c in followed if c.unseen_s <= _CANDIDATE_S]
        if views:
            self._look(views)
        self._place_one(views, by_index)

    def _follow(self, of: FaceCandidate, view: HeadView | None, dt_s: float) -> FaceCandidate:
        older = replace(of, unseen_s=of.unseen_s + dt_s, placed_s=of.placed_s + dt_s)
        if view is None:
            return older
        size = of.box.size_px
        faces = faces_near(
            self._cascade, view.grey, of.box.x_px, of.box.y_px, size, _REACH * size, 2
        )
        if not faces:
            return older
        alive = self._alive(view, faces[0])
        return replace(older, box=faces[0], unseen_s=0.0, looks=of.looks + 1, alive=alive)

    def _place_one(self, views: Sequence[HeadView], by_index: dict[int, HeadView]) -> None:
        """Update the oldest position of the current candidates: only one a step, because it takes time."""
        current = [i for i, c in enumerate(self.candidates) if c.unseen_s == 0.0]
        if not current:
            return
        i = max(current, key=lambda i: self.candidates[i].placed_s)
        of = self.candidates[i]
        placed = self.place(by_index[of.view], of.box, views)
        self.candidates[i] = replace(of, placed=placed, placed_s=0.0)

    def place(self, view: HeadView, box: FaceBox, views: Sequence[HeadView]) -> PlacedFace:
        """The position of the face in this box; mismatches count towards `are_swapped`."""
        placed = placed_face(views, view, box, self._cascade, self._stature_m, self._is_still)
        if placed.is_sure:
            self._straight += 1
        elif any(
            fits_swapped(view, other, box, self._cascade, self._stature_m, self._is_still)
            for other in views
            if other.index != view.index
        ):
            self._crossed += 1
        return placed

    def _look(self, views: Sequence[HeadView]) -> None:
        """Search one part of one picture; cycles through the views, from large faces to small ones."""
        view = views[self._turn % len(views)]
        if not self._work:
            self._turn += 1
            view = views[self._turn % len(views)]
            self._work = _parts(view, self._stature_m)
        windows, n = [np.empty((0, 3))], 0
        while self._work and n < _WINDOWS:
            size, region = self._work.pop(0)
            windows.append(face_windows(self._cascade, view.grey, (size,), region))
            n += _count(size, region)
        tracked = [c.box for c in self.candidates if c.view == view.index]
        places = [
            b
            for b in group_windows(np.concatenate(windows), 1)
            if not any(_over(b, k) for k in tracked)
        ]
        for place in places[:_LOOKS]:
            faces = faces_near(
                self._cascade, view.grey, place.x_px, place.y_px, place.size_px, 0.3 * place.size_px,
                LEAST_WINDOWS,
            )  # fmt: skip
            if faces:
                alive = self._alive(view, faces[0])
                self.candidates.append(FaceCandidate(view.index, faces[0], 0.0, 1, alive))
        self.candidates.sort(key=lambda c: -c.box.size_px)
        del self.candidates[_CANDIDATES:]

    def _is_still(self, view: HeadView, box: FaceBox) -> bool:
        return self._alive(view, box) is False

    def _alive(self, view: HeadView, box: FaceBox) -> bool | None:
        """True if the face's region differs in most pictures of the last seconds."""
        now = _patch(_downscale(view.grey), box)
        then = [
            _patch(pictures[view.index], box)
            for t_s, pictures in self._past
            if self._time_s - t_s >= _OLD_S and view.index in pictures
        ]
        if len(then) < 2 or now.size < 9:
            return None
        changed = [_loss(now, patch) > _STILL for patch in then]
        return bool(np.mean(changed) >= 0.5)


def _parts(view: HeadView, stature_m: float) -> list[tuple[float, tuple[int, int, int, int]]]:
    """Sizes [px] and regions of one sweep over a picture, each of a step's work at most."""
    h, w = view.grey.shape
    wide = FACE_WIDTH * stature_m * float(view.camera.K[0, 0])
    sizes = face_sizes(max(_LEAST_PX, wide / FARTHEST_M), min(wide / NEAREST_M, 0.8 * min(h, w)))
    out = []
    for size in reversed(sizes):
        n = -(-_count(size, (0, 0, w, h)) // _WINDOWS)
        edges = np.linspace(0, h, n + 1).astype(int)
        for top, low in pairwise(edges):
            # strips overlap by a face, so that none is cut
            out.append((size, (0, max(0, int(top - size)), w, int(low))))
    return out


def _count(size_px: float, region: tuple[int, int, int, int]) -> int:
    x0, y0, x1, y1 = region
    return int((x1 - x0) * (y1 - y0) * (WINDOW_PX / size_px / STEP) ** 2)


def _over(a: FaceBox, b: FaceBox) -> bool:
    return bool(np.hypot(a.x_px - b.x_px, a.y_px - b.y_px) < 0.6 * max(a.size_px, b.size_px))


def _downscale(grey: Bytes) -> Bytes:
    h, w = grey.shape
    out = cv2.resize(grey, (w // _SMALL, h // _SMALL), interpolation=cv2.INTER_AREA)
    return np.asarray(out, np.uint8)


def _patch(small: Bytes, box: FaceBox) -> Bytes:
    half, x, y = (a / _SMALL for a in (0.5 * _AROUND * box.size_px, box.x_px, box.y_px))
    x0, y0 = max(0, int(x - half)), max(0, int(y - half))
    return small[y0 : int(y + half) + 1, x0 : int(x + half) + 1]


def _loss(a: Bytes, b: Bytes) -> float:
    """One less the correlation of two patches; 1 where either is flat."""
    x, y = a.astype(float).ravel(), b.astype(float).ravel()
    x, y = x - x.mean(), y - y.mean()
    size = float(np.sqrt((x @ x) * (y @ y)))
    return 1.0 - float(x @ y) / size if size > 1e-6 else 1.0
