"""Silhouettes of a rig's cameras, by background models that are updated outside the body."""

from collections.abc import Sequence

import cv2
import numpy as np

from mocapd.geometry.camera_model import project
from mocapd.published.rao_hodges.params import Params
from mocapd.tracking.pictures import CameraPicture, Pictures
from mocapd.types import Bytes, Camera, Floats, FrameSet, Rig
from mocapd.vision.foreground_kernels import BACKGROUND, UNKNOWN
from mocapd.vision.ghost_removal import brightness_edges
from mocapd.vision.hidden_room import HiddenRoom, guess_room
from mocapd.vision.room_background import RoomBackground


class CameraSilhouette:
    """One camera: its background model and its foreground (h,w)."""

    def __init__(self, picture: CameraPicture, params: Params) -> None:
        """picture: of this camera, renewed by its owner."""
        self.picture = picture
        h, w = picture.bgr.shape[:2]
        self.background = RoomBackground(h, w, params.background)
        self._tolerance = params.background.tolerance
        self._wide_margin, self._close_margin = (
            np.ones((2 * px + 1,) * 2, np.uint8) for px in (params.beside_px, params.close_px)
        )
        self.reset()

    def reset(self) -> None:
        self.background.reset()
        self._before = np.zeros(self.picture.bgr.shape[:2], np.uint8)
        self._body = np.zeros_like(self._before)  # where no background is learned
        self._hidden: HiddenRoom | None = None  # behind an adopted body
        self._drawn = np.zeros_like(self._before)  # the ellipsoids of the body

    def renew(self, uncovered: bool) -> None:
        """Compare the newest picture with the background; uncovered: also move uncovered background into the model."""
        if self.background.follow_light(self.picture.bgr, self._body) is not None:
            self._hidden = None  # the guess is in the light of before
        self._before = self.background.foreground(self.picture.bgr)
        if self._hidden is not None:
            room = self._hidden.is_seen(self.picture.bgr)
            self._before[(self._before == UNKNOWN) & room] = BACKGROUND
        if uncovered:
            no_arms = np.zeros_like(self._body)
            self.background.remove_ghosts(self.picture.bgr, self._before, self._body, no_arms)

    def mask(self) -> Bytes:
        """(h,w): 255 on the foreground, shadows included, and where the background is neither known nor guessed. A hole
        in one silhouette would be a hole in the hull, while shadows of several cameras intersect on the floor only."""
        return np.where(self._before != BACKGROUND, 255, 0).astype(np.uint8)

    def mark_body(self, places_m: Floats) -> None:
        """Exclude a body from learning, with a margin: the ellipsoids that contain these points (E,S,3) [m, world]."""
        self._drawn[:] = 0
        at = (project(self.picture.camera, places_m) + 0.5) / self.picture.image_scale - 0.5
        for one in at:
            if np.isfinite(one).all():
                corners = np.clip(np.rint(one), -10_000, 10_000).astype(np.int32)
                cv2.fillConvexPoly(self._drawn, cv2.convexHull(corners), 1)
        self._body = np.asarray(cv2.dilate(self._drawn, self._wide_margin), np.uint8)

    def mark_foreground(self, absorb: bool) -> None:
        """Exclude the foreground from learning, because it may be a person; absorb: learn everywhere."""
        self._body[:] = 0
        self._drawn[:] = 0
        if not absorb and not self.background.is_new:
            foreground = ((self._before != BACKGROUND) & (self._before != UNKNOWN)).astype(np.uint8)
            self._body = np.asarray(cv2.dilate(foreground, self._wide_margin), np.uint8)

    def learn(self) -> None:
        """Update the background outside the excluded area."""
        self.background.learn(self.picture.bgr, self._body)
        if self._drawn.any():
            h, w = self.picture.bgr.shape[:2]
            near = np.asarray(cv2.dilate(self._drawn, self._close_margin), np.uint8)
            self.background.learn_unknown(self.picture.bgr, near, (0, 0, w, h))

    def seed(self) -> None:
        """Initialise the background from the picture outside the marked body, and guess it behind."""
        near = np.asarray(cv2.dilate(self._drawn, self._close_margin), np.uint8)
        self.background.seed(self.picture.bgr, near)
        guess = guess_room(self.picture.bgr, self._body, self._tolerance)
        self._hidden = guess.where_hidden(self.picture.bgr)

    def edges_at_outline(self) -> tuple[float, float]:
        """The picture's gradient along the marked body's outline, and farther outside of it."""
        if not self._drawn.any():
            return 0.0, 0.0
        edges = brightness_edges(self.picture.bgr)
        near, far = (
            cv2.dilate(self._drawn, kernel) for kernel in (self._close_margin, self._wide_margin)
        )
        inner = cv2.erode(self._drawn, self._close_margin)
        farther = cv2.dilate(far, self._wide_margin)
        return float(edges[near != inner].mean()), float(edges[farther != far].mean())


class RigSilhouettes:
    """All cameras of a rig; `present` are those of the last frame set."""

    def __init__(self, rig: Rig, params: Params) -> None:
        self._pictures = Pictures(rig.cameras, params.work_width_px)
        self._every = [CameraSilhouette(one, params) for one in self._pictures.each]
        self._cameras = rig.cameras
        self.present: list[CameraSilhouette] = []
        self.cameras: list[Camera] = []

    def reset(self) -> None:
        for one in self._every:
            one.reset()

    def look(self, frames: FrameSet) -> None:
        """Process the pictures. Raises ConfigError when a size is not the calibration's."""
        there = self._pictures.load(frames)
        self.present = [self._every[i] for i in there]
        self.cameras = [self._cameras[i] for i in there]

    @property
    def are_new(self) -> bool:
        """True while a camera has no background."""
        return any(one.background.is_new for one in self.present)

    def masks(self) -> Sequence[Bytes]:
        """Of the present cameras."""
        return [one.mask() for one in self.present]

    def renew(self, uncovered: bool) -> None:
        """Compare the newest pictures with the backgrounds."""
        for one in self.present:
            one.renew(uncovered)

    def seed(self, places_m: Floats) -> None:
        """Initialise the backgrounds from the pictures outside a body's ellipsoids; places_m as of `mark_body`."""
        for one in self.present:
            one.mark_body(places_m)
            one.seed()

    def outline_contrast(self, places_m: Floats) -> float:
        """Ratio of the picture gradient along a body's outline to that next to it; about 1 without a person."""
        found = []
        for one in self.present:
            one.mark_body(places_m)
            found.append(one.edges_at_outline())
        on_outline, off_outline = np.array(found).sum(axis=0)
        return float(on_outline / max(off_outline, 1e-3))

    def learn(self, places_m: Floats | None, absorb: bool) -> None:
        """Update the backgrounds outside a body's ellipsoids, or outside the foreground without a body."""
        for one in self.present:
            if places_m is not None:
                one.mark_body(places_m)
            else:
                one.mark_foreground(absorb)
            one.learn()
