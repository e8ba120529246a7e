"""One camera's state for the clothes cue: downscaled picture, background model, foreground mask and appearance model;
and which of its pixels show the floor about a person, where shadows fall."""

import cv2
import numpy as np
from numpy.typing import NDArray

from mocapd.fit.idmap_renderer import Roi
from mocapd.fit.work_rays import work_rays_in_world
from mocapd.fit.work_size import work_size
from mocapd.geometry.camera_model import centre
from mocapd.tracking.cues.clothes.appearance import Appearance
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.types import Bytes, Camera, Floats, Singles
from mocapd.vision.foreground_kernels import near_on_floor
from mocapd.vision.ghost_removal import brightness_edges
from mocapd.vision.heatmaps.person_crop import PersonCrop
from mocapd.vision.room_background import RoomBackground

# half of it: distance of the pixels that are compared with the outline's
_OUTLINE_OFFSET = np.ones((13, 13), np.uint8)
_OUTLINE_WIDTH = np.ones((3, 3), np.uint8)
_REACH_M = 1.5  # shadows of a lamp at the ceiling are shorter than that; those of low lamps fall on walls, too
_FAR_M = 1e3


class CameraView:
    """One camera: its newest work picture, background and appearance."""

    def __init__(
        self, name: str, work_size_px: tuple[int, int], image_scale: int, params: ClothesParams
    ) -> None:
        """work_size_px: width and height of its work pictures; image_scale: by how much frames are averaged down."""
        self.name, self.image_scale = name, image_scale
        w, h = work_size_px
        self.picture = np.zeros((h, w, 3), np.uint8)
        self.foreground = np.zeros((h, w), np.uint8)
        self.body = np.zeros((h, w), np.uint8)  # the body with a margin, or a possible person
        self.drawn = np.zeros((h, w), np.uint8)  # the tracked body
        # log-odds of the network in this frame set; 0 outside its crop
        self.person_odds = np.zeros((h, w), np.float32)
        self.has_new_odds = False  # of this very picture
        self._newest_odds: tuple[Singles, PersonCrop] | None = None  # also of an earlier frame set
        self.near: Roi | None = None  # the region about it
        self.is_covered = False  # about the body, by somebody close to the lens
        self.background = RoomBackground(h, w, params.background)
        self.appearance = Appearance(params.appearance)
        # the background, if learned from a recording with a person in it
        self.may_hold_body = False
        self.body_margin, self._moved_margin, self.close_margin = (
            np.ones((2 * px + 1,) * 2, np.uint8)
            for px in (params.beside_px, params.moved_px, params.close_px)
        )
        self._stood = params.stood

    def reset(self) -> None:
        """Forget background and appearance."""
        self.background.reset()
        self.appearance.reset()
        self.may_hold_body = False
        self.mark_body(None)

    def take(self, picture: Bytes) -> None:
        """Stores a work picture (h,w,3), in which nobody is marked yet."""
        self.picture = picture
        self.person_odds[:] = 0.0
        self.has_new_odds = False

    def mark_body(self, drawn: tuple[Roi, Bytes] | None) -> None:
        """Marks the body, a region and its rendered ids (h,w), with a margin, so that the background does not learn it;
        None: no body."""
        self.body[:] = 0
        self.drawn[:] = 0
        self.near = None
        if drawn is None:
            self._newest_odds = None
        else:
            self.near, ids = drawn
            x0, y0, x1, y1 = self.near
            here = (ids > 0).astype(np.uint8)
            self.drawn[y0:y1, x0:x1] = here
            # the region has a wider margin than that
            self.body[y0:y1, x0:x1] = cv2.dilate(here, self.body_margin)

    def mark_person(self, odds: Singles, crop: PersonCrop, *, is_new: bool = True) -> None:
        """Stores the network's log-odds (96,96) of the person in a crop of the picture. is_new: it looked at this picture,
        not at one before."""
        self.has_new_odds, self._newest_odds = is_new, (odds, crop)
        _paste(odds, crop, self.person_odds)

    def person_by_network(self) -> NDArray[np.bool_]:
        """(h,w): what the network took for the tracked person when it looked last, at most a few pictures ago."""
        if self._newest_odds is None:
            return np.zeros(self.person_odds.shape, bool)
        return self.person_in(*self._newest_odds)

    def person_in(self, odds: Singles, crop: PersonCrop) -> NDArray[np.bool_]:
        """(h,w): where log-odds (96,96) of a crop of the picture say person."""
        everywhere = np.zeros_like(self.person_odds)
        _paste(odds, crop, everywhere)
        return everywhere > 0.0

    def learned_body(self) -> NDArray[np.bool_]:
        """(h,w): where the marked body looks like the background, as one that was learned with it does."""
        return self.background.looks_like(self.picture) & (self.drawn > 0)

    def forget_person(self) -> None:
        """Clears the background under the marked body: with a margin where it stood when the background was learned, as what
        differs from it there may be another part of it; elsewhere what looks like it."""
        there = self.learned_body()
        if np.count_nonzero(there) > self._stood * np.count_nonzero(self.drawn):
            there = np.asarray(cv2.dilate(self.drawn, self._moved_margin) > 0)
        self.background.forget(there)

    def learn_background(self, agrees: bool, ticks: int = 1) -> None:
        """Updates the background outside the marked body. agrees: the body fits the picture, so pixels without a background
        are learned close to it, too."""
        self.background.learn(self.picture, self.body, ticks)
        if agrees and self.near is not None:
            x0, y0, x1, y1 = self.near
            body = np.asarray(cv2.dilate(self.drawn[y0:y1, x0:x1], self.close_margin), np.uint8)
            self.background.learn_unknown(self.picture, body, self.near)

    def update_foreground(self, everywhere: bool = True) -> None:
        """Updates light and foreground mask; not everywhere: only about the marked body."""
        gain = self.background.follow_light(self.picture, self.body)
        if gain is not None:
            self.appearance.relight(gain)
        nowhere = (0, 0, 0, 0)
        within = None if everywhere else self.near or nowhere
        self.foreground = self.background.foreground(self.picture, within)

    def outline_edges(self) -> tuple[float, float]:
        """Mean image gradient on the marked body's outline, and near it."""
        edges = brightness_edges(self.picture)
        wide = np.asarray(cv2.dilate(self.drawn, _OUTLINE_OFFSET), np.uint8)
        narrow = np.asarray(cv2.erode(self.drawn, _OUTLINE_OFFSET), np.uint8)
        off = _outline(wide) | _outline(narrow)
        return float(edges[_outline(self.drawn)].mean()), float(edges[off].mean())


def _paste(odds: Singles, crop: PersonCrop, out: Singles) -> None:
    """Log-odds (96,96) of a crop as those of the picture (h,w), 0 outside."""
    h, w = out.shape
    cv2.warpAffine(
        odds, crop.affine, (w, h), dst=out, flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP, borderValue=(0.0,)
    )  # fmt: skip


def _outline(mask: Bytes) -> NDArray[np.bool_]:
    return np.asarray(cv2.morphologyEx(mask, cv2.MORPH_GRADIENT, _OUTLINE_WIDTH) > 0)


class FloorView:
    """Where each work pixel's ray meets the plane y = 0."""

    def __init__(self, camera: Camera, image_scale: int) -> None:
        w, h = work_size(camera, image_scale)
        along = work_rays_in_world(camera, image_scale)[:h, :w].reshape(-1, 3)
        eye = centre(camera)
        down = np.minimum(along[:, 1], -1e-6)
        met = eye + along * (-eye[1] / down)[:, None]
        met[along[:, 1] > -1e-3] = _FAR_M
        self._met_x, self._met_z = (
            np.ascontiguousarray(met[:, i].reshape(h, w), np.float32) for i in (0, 2)
        )

    def near(self, root_m: Floats, roi: Roi) -> Bytes:
        """(h,w) of the region: 1 where an empty room would show the floor about a body with this root (3,)."""
        x0, y0, x1, y1 = roi
        near = np.empty((y1 - y0, x1 - x0), np.uint8)
        near_on_floor(self._met_x, self._met_z, x0, y0, root_m[0], root_m[2], _REACH_M, near)
        return near
