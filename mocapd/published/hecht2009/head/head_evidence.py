"""Evidence of a tracked head in the pictures of one instant: face, distance and colours."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mocapd.body.head_proportions import FACE_WIDTH
from mocapd.geometry.camera_model import centre, to_camera
from mocapd.published.hecht2009.face.face_detection import FaceBox, faces_near
from mocapd.published.hecht2009.face.lbp_cascade_kernels import CascadeArrays
from mocapd.published.hecht2009.head.face_placing import PlacedFace, apparent_distance_m, middle_px
from mocapd.published.hecht2009.head.head_cloud import Cloud, along_ray, at_distance
from mocapd.published.hecht2009.head.head_colours import (
    HeadColours,
    face_side,
    has_colours,
    initial_colours,
    light_gain,
    update_colours,
)
from mocapd.published.hecht2009.head.head_params import (
    FACE_DEPTH_SD,
    FACE_SD,
    LEARN_SUPPORT,
)
from mocapd.published.hecht2009.head.head_particle_kernels import score_heads
from mocapd.published.hecht2009.head.head_samples import INSIDE, OUTLINE
from mocapd.published.hecht2009.head.head_shape import ellipse_of, head_size
from mocapd.published.hecht2009.head.head_views import HeadView, have_baseline, ray_through
from mocapd.published.hecht2009.head.stereo_distance import (
    WIDEST_RAD,
    Distance,
    swept_distance,
    view_angle_rad,
)
from mocapd.types import Bytes, Floats

_DEPTH_REACH_M = 0.35  # of the search for the distance about the predicted one
_COLOUR_WEIGHT = 6.0  # logarithm of a likelihood, by the difference of two odds -1..1
_REACH = 0.5  # of the face's side: search radius about the predicted place
_SAME = 0.7  # of the face's side: a face farther away belongs to another head
_WINDOWS = 1  # detections that confirm a predicted face
_PATCH = 0.8  # of the head's half height: the patch whose distance is taken
# patches for a head that is partly hidden by hands: crown, left, right; middle in half widths and heights, and size
_PARTS = ((0.0, 0.45, 0.45), (-0.45, 0.0, 0.45), (0.45, 0.0, 0.45))
_GATE_M = 0.04  # beyond the uncertainty: a distance that jumps farther is of another object
_NEARER_M = 0.1  # limit of a jump towards the camera, for any uncertainty: a hand in front of the face is that near
_LEAST_SKIN = 0.12  # share of the head, under which it is turned away
_FULL_SIDE = 0.5  # offset of the skin's middle on a head in profile
_NO_FOREGROUND = np.zeros((0, 0), np.uint8)
# a hand before the face lowers the correlation: accepted loss, relative to that of detected faces
_LOSS_TIMES = 2.5
_LOSS_MORE = 0.01
_USUAL_LOSS = 0.05  # initial value
_LOSS_SHARE = 0.05  # weight of a new face in the running mean


@dataclass(frozen=True, slots=True, eq=False)
class HeadGuess:
    """Predicted middle (3,) of the head [m], its velocity (3,) [m/s], and one standard deviation of its distance."""

    middle_m: Floats
    velocity_m_s: Floats
    sigma_along_m: float


@dataclass(frozen=True, slots=True, eq=False)
class HeadSighting:
    """Boxes by camera index, the input of `head_cloud.observations`, and whether it has a face and a distance."""

    boxes: tuple[FaceBox | None, ...]
    parts: list[tuple[Floats, Floats]]
    is_complete: bool


class HeadEvidence:
    """Holds each camera's colour model of the head."""

    def __init__(self, n_cameras: int, cascade: CascadeArrays, stature_m: float) -> None:
        self._n, self._cascade = n_cameras, cascade
        self._stature_m, self._size = stature_m, head_size(stature_m)
        self._half = np.array([self._size.width_m, self._size.height_m])
        self.reset()

    def reset(self) -> None:
        """Forget the colours."""
        self._colours: list[HeadColours] = [initial_colours() for _ in range(self._n)]
        self._turn = 0
        self._loss = _USUAL_LOSS

    def observe(self, views: Sequence[HeadView], guess: HeadGuess) -> HeadSighting:
        """Faces near the predicted head in each view, and its distance from pairs of views."""
        boxes: list[FaceBox | None] = [None] * self._n
        parts: list[tuple[Floats, Floats]] = []
        self._turn += 1
        for i, view in enumerate(views):
            at_m = guess.middle_m + view.offset_s * guess.velocity_m_s
            if i == self._turn % len(views):
                boxes[view.index] = self._face(view, at_m)
        is_complete = has_distance = False
        # the view with the first face detection: its distance is the surest
        for view in sorted(views, key=lambda v: boxes[v.index] is None):
            pair = self._distance(views, view, boxes[view.index], guess)
            if pair is not None:
                parts.append(pair)
                has_distance, is_complete = True, boxes[view.index] is not None
                break
        for view in views:
            box = boxes[view.index]
            if box is not None:
                parts += self._of_face(view, box, guess, has_distance)
        return HeadSighting(tuple(boxes), parts, is_complete)

    def _face(self, view: HeadView, at_m: Floats) -> FaceBox | None:
        outline = ellipse_of(view.camera, at_m, self._size)
        if outline is None:
            return None
        x, y = outline.ellipse[:2].tolist()
        side = FACE_WIDTH * self._stature_m * float(view.camera.K[0, 0]) / self._depth_m(view, at_m)
        near = faces_near(self._cascade, view.grey, x, y, side, _REACH * side, _WINDOWS)
        near = tuple(b for b in near if np.hypot(b.x_px - x, b.y_px - y) < _SAME * side)
        return near[0] if near else None

    def _depth_m(self, view: HeadView, at_m: Floats) -> float:
        return max(float(to_camera(view.camera, at_m)[2]), 0.1)

    def _of_face(
        self, view: HeadView, box: FaceBox, guess: HeadGuess, has_distance: bool
    ) -> list[tuple[Floats, Floats]]:
        """A face measures the head's position across the ray and, without a pair, its distance by size."""
        from_m, ray = ray_through(view, middle_px(box))
        # where the head is now, not when this picture was taken
        from_m = from_m - view.offset_s * guess.velocity_m_s
        depth_m = self._depth_m(view, guess.middle_m)
        across_m = FACE_SD * box.size_px * depth_m / float(view.camera.K[0, 0])
        out = [along_ray(from_m, ray, across_m)]
        if not has_distance:
            apparent_m = apparent_distance_m(view, box, self._stature_m)
            out.append(at_distance(from_m, ray, apparent_m, FACE_DEPTH_SD * apparent_m))
        return out

    def _distance(
        self, views: Sequence[HeadView], near: HeadView, box: FaceBox | None, guess: HeadGuess
    ) -> tuple[Floats, Floats] | None:
        """From this view and a close second one: of the head, or of its part without a hand in front."""
        at_m = guess.middle_m + near.offset_s * guess.velocity_m_s
        outline = ellipse_of(near.camera, at_m, self._size)
        if outline is None:
            return None
        x, y, half_w, half_h = outline.ellipse.tolist()
        up = outline.up
        right = np.array([-up[1], up[0]])
        middle = np.array([x, y]) if box is None else middle_px(box)
        patches = [(middle, _PATCH * half_h)]
        if box is None:
            patches += [(middle + a * half_w * right + b * half_h * up, c * half_h) for a, b, c in _PARTS]  # fmt: skip
        away_m = float(np.linalg.norm(at_m - centre(near.camera)))
        farther_m = np.inf if box is not None else _GATE_M + 2.0 * guess.sigma_along_m
        nearer_m = np.inf if box is not None else min(farther_m, _NEARER_M)
        for other in views:
            if other.index == near.index or not have_baseline(other.camera, near.camera):
                continue
            if view_angle_rad(near.camera, other.camera, guess.middle_m) > WIDEST_RAD:
                continue
            for patch, half_px in patches:
                found = self._swept(near, other, patch, half_px, away_m, guess)
                if found is None or not self._is_bare(found):
                    continue
                if -nearer_m < found.distance_m - away_m < farther_m:
                    if box is not None:
                        self._loss += _LOSS_SHARE * (1.0 - found.correlation - self._loss)
                    from_m, ray = ray_through(near, middle)
                    from_m = from_m - near.offset_s * guess.velocity_m_s
                    return at_distance(from_m, ray, found.distance_m, found.sigma_m)
        return None

    def _is_bare(self, found: Distance) -> bool:
        """True if the two views of the patch agree as well as at the last face detection."""
        return 1.0 - found.correlation <= _LOSS_TIMES * self._loss + _LOSS_MORE

    def _swept(
        self, near: HeadView, other: HeadView, patch_px: Floats, half_px: float, away_m: float, guess: HeadGuess
    ) -> Distance | None:  # fmt: skip
        return swept_distance(
            near.stereo, other.stereo, patch_px, half_px,
            (max(away_m - _DEPTH_REACH_M, 0.3), away_m + _DEPTH_REACH_M), self._size.length_m,
            (other.offset_s - near.offset_s) * guess.velocity_m_s,
        )  # fmt: skip

    def log_likelihood(self, views: Sequence[HeadView], cloud: Cloud, guess_m: Floats) -> Floats:
        """Scores of the particles (P,), by colours, outline and foreground."""
        out = np.zeros(len(cloud.place_m))
        for view in views:
            if has_colours(self._colours[view.index]) or view.has_foreground:
                middles = cloud.place_m + view.offset_s * cloud.velocity_m_s
                score = self._scores(view, middles, guess_m, view.foreground)
                if score is not None:
                    out += _COLOUR_WEIGHT * score
        return out

    def support(self, views: Sequence[HeadView], middle_m: Floats, velocity_m_s: Floats) -> float:
        """Score of colours and outline at one place, in the best view; 0 before colours are learned."""
        at_m = [middle_m + view.offset_s * velocity_m_s for view in views]
        return max((self._sure(v, at) for v, at in zip(views, at_m, strict=True)), default=0.0)

    def _sure(self, view: HeadView, at_m: Floats) -> float:
        if not has_colours(self._colours[view.index]):
            return 0.0
        score = self._scores(view, at_m[None], at_m, _NO_FOREGROUND)
        return 0.0 if score is None else float(score[0])

    def _scores(
        self, view: HeadView, middles_m: Floats, guess_m: Floats, foreground: Bytes
    ) -> Floats | None:
        outline = ellipse_of(view.camera, guess_m, self._size)
        if outline is None:
            return None
        out = np.empty(len(middles_m))
        score_heads(
            np.ascontiguousarray(middles_m), self._half, INSIDE, OUTLINE, view.stereo.arrays, view.pixels,
            self._colours[view.index].head_odds, light_gain(view.pixels, outline), foreground, outline.up, out,
        )  # fmt: skip
        return out

    def learn_first(self, views: Sequence[HeadView], face: PlacedFace) -> None:
        """Update the colours in views with a detected face."""
        for view in views:
            outline = ellipse_of(view.camera, face.middle_m, self._size)
            if outline is not None:
                self._colours[view.index] = update_colours(
                    self._colours[view.index], view.pixels, outline, view.index in face.boxes, 0.0
                )

    def learn(
        self, views: Sequence[HeadView], middle_m: Floats, velocity_m_s: Floats,
        boxes: Sequence[FaceBox | None], dt_s: float,
    ) -> None:  # fmt: skip
        """Update the colours in views with a face, or with an equally certain head."""
        for view in views:
            at_m = middle_m + view.offset_s * velocity_m_s
            outline = ellipse_of(view.camera, at_m, self._size)
            if outline is None:
                continue
            facing = boxes[view.index] is not None
            if facing or self._sure(view, at_m) >= LEARN_SUPPORT:
                self._colours[view.index] = update_colours(
                    self._colours[view.index], view.pixels, outline, facing, dt_s
                )

    def yaw_rad(
        self, views: Sequence[HeadView], middle_m: Floats, velocity_m_s: Floats
    ) -> float | None:
        """Yaw of a just detected face, by the side of the head with the skin; None: unknown.

        Coarse, 10 to 30 degrees, and only for heads that show their face: hair may have the colour of skin.
        """
        way = np.zeros(2)
        for view in views:
            at_m = middle_m + view.offset_s * velocity_m_s
            outline = ellipse_of(view.camera, at_m, self._size)
            side = outline and face_side(self._colours[view.index], view.pixels, outline)
            if not side or side[0] < _LEAST_SKIN:
                continue
            towards = centre(view.camera) - at_m
            yaw = np.arctan2(towards[0], towards[2]) + np.arcsin(np.clip(side[1] / _FULL_SIDE, -1.0, 1.0))  # fmt: skip
            way += side[0] * np.array([np.sin(yaw), np.cos(yaw)])
        return float(np.arctan2(way[0], way[1])) if way.any() else None
