"""Real video of people who sign before one webcam: how often the head's face is found."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from mocapd.capture.file import FileSource
from mocapd.clock import seconds
from mocapd.errors import EndOfStream
from mocapd.geometry.nominal_rig import nominal_rig
from mocapd.published.hecht2009.face.lbp_cascade_kernels import CascadeArrays
from mocapd.published.hecht2009.head.head_shape import ellipse_of, head_size
from mocapd.published.hecht2009.head.head_track import HeadPicture, HeadTrack
from mocapd.published.hecht2009.head.head_tracker import HeadTracker
from mocapd.types import Bytes, Camera, Frame
from tests.real_videos.contact_sheet import LEFT, MIDDLE

STATURE_M = 1.70  # not known of these people; with one camera it scales the distance alone
_TILE_PX = (160, 120)


@dataclass(frozen=True, slots=True, eq=False)
class SigningClip:
    """One clip of F frames: faces (F,), whether the face was found in each; heads (F,), whether a head was known; tiles:
    some of its pictures."""

    name: str
    faces: Sequence[bool]
    heads: Sequence[bool]
    tiles: Sequence[Bytes]


def frames_of(video: Path) -> Iterator[Frame]:
    """All frames of a video."""
    source = FileSource(video.stem, video)
    source.open()
    try:
        while True:
            yield source.read()
    except EndOfStream:
        source.close()


def signing_clip(video: Path, cascade: CascadeArrays, tiles: int) -> SigningClip:
    """The head followed from the first frame of a clip to its last, with so many pictures of it."""
    frames = list(frames_of(video))
    h, w = frames[0].pixels.shape[:2]
    (camera,) = nominal_rig("cam0", (w, h)).cameras
    tracker = HeadTracker((camera,), STATURE_M, cascade)
    shown = set(np.linspace(0, len(frames) - 1, tiles + 1).astype(int)[1:].tolist())
    faces, heads, pictures = [], [], []
    before_ns = frames[0].t_ns - 33_333_333
    for number, frame in enumerate(frames):
        track = tracker.step([HeadPicture(frame.pixels)], seconds(frame.t_ns - before_ns))
        before_ns = frame.t_ns
        faces.append(any(box is not None for box in track.boxes))
        heads.append(track.middle_m is not None)
        if number in shown:
            pictures.append(_tile(frame.pixels, camera, track))
    return SigningClip(video.stem, faces, heads, pictures)


def _tile(pixels: Bytes, camera: Camera, track: HeadTrack) -> Bytes:
    """The picture with the head's outline and the box of its face, as far as they are known."""
    out = pixels.copy()
    for box in track.boxes:
        if box is not None:
            half = 0.5 * box.size_px
            corners = [(int(box.x_px + s * half), int(box.y_px + s * half)) for s in (-1, 1)]
            cv2.rectangle(out, corners[0], corners[1], LEFT, 3)
    if track.middle_m is not None:
        outline = ellipse_of(camera, track.middle_m, head_size(STATURE_M))
        if outline is not None:
            x, y, a, b = (int(value) for value in outline.ellipse)
            turn = float(np.degrees(np.arctan2(outline.up[0], -outline.up[1])))
            cv2.ellipse(out, (x, y), (a, b), turn, 0, 360, MIDDLE, 3)
    return np.asarray(cv2.resize(out, _TILE_PX, interpolation=cv2.INTER_AREA), np.uint8)
