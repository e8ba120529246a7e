"""Evidence of each camera: work picture, edges and motion, foreground, and occlusion model."""

from collections.abc import Sequence

import cv2
import numpy as np

from mocapd.clock import seconds
from mocapd.fit.work_size import image_scales
from mocapd.geometry.camera_model import project
from mocapd.published.hecht2009.cylinders.limb_score import LimbView
from mocapd.published.hecht2009.cylinders.occlusion import allocate_occlusion, fill_occlusion
from mocapd.published.hecht2009.cylinders.part_colours import AppearanceModel, RingColours, observe
from mocapd.published.hecht2009.cylinders.work_camera import work_camera
from mocapd.published.hecht2009.head.head_track import HeadPicture
from mocapd.published.hecht2009.mass_spring.frusta import NAMES
from mocapd.published.hecht2009.motion_edges import (
    MotionEdges,
    WorkPicture,
    motion_edges,
    work_picture,
)
from mocapd.published.hecht2009.params import Params
from mocapd.published.hecht2009.part_samples import PartSamples, samples_of
from mocapd.types import Bytes, Camera, Floats, Frame, FrameSet, Rig, Singles
from mocapd.vision.foreground_kernels import BACKGROUND, SHADOW, UNKNOWN
from mocapd.vision.frame_size import check_frame_size
from mocapd.vision.hidden_room import HiddenRoom, guess_room
from mocapd.vision.room_background import RoomBackground

_ALONG = (np.arange(6) + 0.5) / 6.0  # sample positions on a part, from start to end


class CameraEvidence:
    """One camera: its newest evidence at work size (h,w)."""

    def __init__(self, index: int, camera: Camera, image_scale: int, params: Params) -> None:
        self.index, self.camera, self.image_scale, self._params = index, camera, image_scale, params
        w, h = (n // image_scale for n in camera.size_px)
        self._size_px = w, h
        self._scale = np.array([w, h]) / camera.size_px
        self.work_camera = work_camera(camera, (w, h))
        self._now: WorkPicture  # from the first frame on, as the next
        self._edges: MotionEdges
        self.background = RoomBackground(h, w, params.background)
        self.before = np.zeros((h, w), np.uint8)
        self._body = np.zeros((h, w), np.uint8)
        self._beside = np.ones((2 * params.beside_px + 1,) * 2, np.uint8)
        self._occlusion = allocate_occlusion(len(NAMES), (w, h), params.score.cell_px)
        self._hidden: HiddenRoom | None = None  # behind an adopted body
        self._pixels: Bytes | None = None
        self.offset_s = 0.0
        self._quads, self._depths_m = np.empty((len(NAMES), 4, 2)), np.empty((len(NAMES), 2))

    def reset(self) -> None:
        """Forget the background and the last picture."""
        self.background.reset()
        self.before[:] = 0
        self._body[:] = 0
        self._hidden = None
        self._pixels = None

    @property
    def present(self) -> bool:
        """True if the last frame set had a frame of this camera."""
        return self._pixels is not None

    def look(self, frame: Frame | None, offset_s: float) -> None:
        """Process a frame, or None. Raises ConfigError when its size is not the calibration's."""
        last = None if self._pixels is None else self._now.grey
        self._pixels, self.offset_s = None, offset_s
        if frame is None:
            return
        check_frame_size(frame, self.camera.size_px)
        self._pixels = frame.pixels
        self._now = work_picture(frame.pixels, self._size_px)
        self._edges = motion_edges(self._now.grey, last)

    def update_foreground(self, uncovered: bool) -> None:
        """Update the foreground; uncovered: also move uncovered background (ghosts) into the background model."""
        if self.background.follow_light(self._now.colour, self._body) is not None:
            self._hidden = None  # the guess is in the light of before
        self.before = self.background.foreground(self._now.colour)
        if self._hidden is not None:
            room = self._hidden.is_seen(self._now.colour)
            self.before[(self.before == UNKNOWN) & room] = BACKGROUND
        if uncovered:
            no_arms = np.zeros_like(self._body)
            self.background.remove_ghosts(self._now.colour, self.before, self._body, no_arms)

    def mark_body(self, ends_m: Floats | None, radii_m: Floats) -> None:
        """Mark the body: parts of ends (C,2,3) and radii (C,2) [m]. The background is not learned in their widened outlines,
        and they occlude each other. None: no body is tracked."""
        self._body[:] = 0
        if ends_m is None:
            return
        self._quads, self._depths_m = fill_occlusion(
            self._occlusion, self.work_camera, ends_m, radii_m
        )
        for quad in self._quads:
            if np.isfinite(quad).all():
                corners = np.clip(np.rint(quad), -10_000, 10_000).astype(np.int32)
                cv2.fillConvexPoly(self._body, corners, 1)
        self._body = np.asarray(cv2.dilate(self._body, self._beside), np.uint8)

    def mark_unknown(self) -> None:
        """Mark the whole foreground as a possible person."""
        if not self.background.is_new:
            known = ((self.before > 0) & (self.before != UNKNOWN)).astype(np.uint8)
            self._body = np.asarray(cv2.dilate(known, self._beside), np.uint8)

    def learn_background(self) -> None:
        """Update the background outside the marked area."""
        self.background.learn(self._now.colour, self._body)

    def seed_background(self) -> None:
        """Initialise the background from the picture outside the marked body, and guess it behind."""
        self.background.seed(self._now.colour, self._body)
        self._hidden = guess_room(self._now.colour, self._body, self._params.background.tolerance)

    def person(self) -> Bytes:
        """(h,w): 255 on the foreground, dark cloth included, and where the background is unknown."""
        return np.where((self.before > 0) & (self.before != SHADOW), 255, 0).astype(np.uint8)

    def head_picture(self) -> HeadPicture:
        """The frame as input of the head tracker."""
        if self._pixels is None:
            return HeadPicture(None)
        foreground = None
        if not self.background.is_new:
            size = self.camera.size_px
            foreground = np.asarray(
                cv2.resize(self.person(), size, interpolation=cv2.INTER_NEAREST), np.uint8
            )
        return HeadPicture(self._pixels, self.offset_s, foreground)

    def limb_view(self, reference: Singles) -> LimbView:
        """The evidence as input of the limbs' filters; reference (C,along,3): colours of the parts."""
        return LimbView(
            self.index, self.work_camera, self._now.colour, self._edges.edges, self._edges.motion, reference,
            self._occlusion,
        )  # fmt: skip

    def ring_colours(self) -> RingColours:
        """The colours of the marked parts on the foreground."""
        return observe(
            self._quads, self._depths_m, self._now.colour, self.person(), self._occlusion,
            self._params.score.hidden_by_m,
        )  # fmt: skip

    def count_samples(self, ends_m: Floats) -> PartSamples:
        """The samples on each part's axis (C,2,3) [m], by what they show in this picture."""
        along = ends_m[:, :1] + _ALONG[:, None] * (ends_m[:, 1:] - ends_m[:, :1])
        xy = (project(self.camera, along.reshape(-1, 3)) + 0.5) * self._scale
        w, h = self._size_px
        inside = np.asarray(np.isfinite(xy).all(axis=1))
        inside &= (np.nan_to_num(xy) >= 0.0).all(axis=1) & (np.nan_to_num(xy) < (w, h)).all(axis=1)
        at = np.where(inside[:, None], np.nan_to_num(xy), 0.0).astype(int)
        return samples_of(self.before[at[:, 1], at[:, 0]], inside, len(_ALONG))


class RigEvidence:
    """All cameras of a rig, and the appearance of the parts in each."""

    def __init__(self, rig: Rig, params: Params) -> None:
        scales = image_scales(rig.cameras, params.work_width_px)
        self.each = [
            CameraEvidence(i, camera, scale, params)
            for i, (camera, scale) in enumerate(zip(rig.cameras, scales, strict=True))
        ]
        self.reset()

    def reset(self) -> None:
        """Reset backgrounds and appearance."""
        for view in self.each:
            view.reset()
        self.forget_person()

    def forget_person(self) -> None:
        """Reset the person's appearance."""
        self.appearance = AppearanceModel.initial(len(self.each), len(NAMES))

    def look(self, frames: FrameSet) -> None:
        """Process the pictures. Raises ConfigError when a size is not the calibration's."""
        for view in self.each:
            frame = frames.frames.get(view.camera.name)
            if frame is None:
                view.look(None, 0.0)
            else:
                view.look(frame, seconds(frame.t_ns - frames.t_ns))

    @property
    def present(self) -> Sequence[CameraEvidence]:
        """The cameras of the last frame set."""
        return [view for view in self.each if view.present]

    def count_samples(self, ends_m: Floats) -> PartSamples:
        """The samples on each part's axis (C,2,3) [m], by what they show in all present pictures."""
        each = (view.count_samples(ends_m) for view in self.present)
        return sum(each, PartSamples.none(len(ends_m)))
