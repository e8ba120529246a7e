"""Real video of a man who balances on a beam before two cameras: how much of his skeleton lies inside of him."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np

from mocapd.body.shape import mean_shape
from mocapd.body.skeleton import PARENTS
from mocapd.calibration.calibration_record import Calibration, Wearer
from mocapd.capture.capture_folder import sources_in_step
from mocapd.capture.file import FileSource, probe_video
from mocapd.clock import seconds
from mocapd.geometry.camera_model import project
from mocapd.geometry.rig_file import camera_from_dict
from mocapd.session.offline import learn_room
from mocapd.types import Bytes, Camera, Floats, FrameSet, Rig
from mocapd.vision.clip_background import clip_background
from mocapd.vision.foreground_kernels import BEFORE, CLOTH_OR_SHADOW, UNKNOWN
from mocapd.vision.room_background import BackgroundParams, RoomBackground
from tests.real_videos.contact_sheet import draw_skeleton
from tests.tracking.profiles import markerless_tracker

CAMERAS = ("cam01", "cam02")  # neighbours before him, 2.9 m apart
OTHERS = ("cam03", "cam04")  # behind him
STATURE_M = 1.70  # the top of his cap before the floor, by both cameras, where he stands upright
SCALE = 3  # of the pictures looked at, smaller than the videos
NEAR_PX = 3  # about his outline [px of the small pictures]: two centimetres
INSIDE = 0.9  # of the points along the bones, for a skeleton that counts as inside
_ROOM_EVERY = 2  # of the frames, those of which the room is made
_ALONG = np.linspace(0.0, 1.0, 5)  # points on each bone
_Z_UP_FROM_Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])


@dataclass(frozen=True, slots=True, eq=False)
class BeamWalk:
    """frames: how many were looked at; inside, elsewhere: by frame in which he is told, the share of his bones inside of
    him in the cameras that the tracker sees and in the others; tiles: some pictures of the first, a row for each camera."""

    frames: int
    inside: Mapping[int, float]
    elsewhere: Mapping[int, float]
    tiles: Sequence[Sequence[Bytes]]

    def share(self, of: Mapping[int, float]) -> float:
        """Of all frames, those in which the skeleton is inside of him."""
        return sum(value >= INSIDE for value in of.values()) / self.frames


def beam_rig(folder: Path) -> Rig:
    """All cameras, in a world whose Y is up."""
    cameras = []
    for entry in json.loads((folder / "calib_opencv.json").read_text())["cameras"]:
        turned = (np.array(entry["R"]) @ _Z_UP_FROM_Y_UP).tolist()
        fields = entry | {"size": entry["image_size"], "R": turned}
        cameras.append(camera_from_dict(fields, str(folder)))
    return Rig(tuple(cameras))


def beam_walk(
    folder: Path, tiles: int, every: int = 1, tracking: tuple[str, ...] = CAMERAS
) -> BeamWalk:
    """He is tracked in every frame by these cameras and looked at in one of `every`, with so many pictures of it."""
    cameras = {camera.name: camera for camera in beam_rig(folder).cameras}
    seeing = tuple(cameras[name] for name in tracking)
    others = tuple(name for name in cameras if name not in tracking)
    tracker = markerless_tracker(Calibration(Rig(seeing), Wearer(STATURE_M)))
    shape = mean_shape(STATURE_M)

    def sets(names: Sequence[str]) -> Iterator[FrameSet]:
        return sources_in_step([FileSource(one, folder / f"{one}.mp4") for one in names])

    n = probe_video(folder / f"{CAMERAS[0]}.mp4").frames
    pictured = set(np.linspace(0, n - 1, tiles + 1).astype(int)[1:].tolist())
    small: dict[str, dict[int, Bytes]] = {name: {} for name in cameras}
    times_s = []

    def seen() -> Iterator[FrameSet]:
        """What the tracker sees; kept are small pictures of all cameras."""
        for number, one in enumerate(sets(tuple(cameras))):
            times_s.append(seconds(one.t_ns))
            if number % _ROOM_EVERY == 0 or number % every == 0 or number in pictured:
                for name, shown in small.items():
                    shown[number] = _smaller(one.frames[name].pixels)
            yield replace(one, frames={name: one.frames[name] for name in tracking})

    learn_room(tracker, seen(), n)
    assert len(times_s) == n
    rooms = {name: _room(shown, times_s) for name, shown in small.items()}
    inside: dict[int, float] = {}
    elsewhere: dict[int, float] = {}
    rows: list[list[Bytes]] = [[] for _ in tracking]
    for number, one in enumerate(sets(tracking)):
        joints_m = tracker.step(one, shape).body.joints_m
        if joints_m is not None and number % every == 0:
            for names, shares in ((tracking, inside), (others, elsewhere)):
                if not names:
                    continue
                before = [rooms[name].foreground(small[name][number]) for name in names]
                shares[number] = share_inside([cameras[name] for name in names], joints_m, before)
        if number in pictured:
            for row, camera in zip(rows, seeing, strict=True):
                row.append(_tile(small[camera.name][number], camera, joints_m))
    return BeamWalk(len(range(0, n, every)), inside, elsewhere, rows)


def share_inside(cameras: Sequence[Camera], joints_m: Floats, before: Sequence[Bytes]) -> float:
    """Of points along the bones of joints (J,3), as each camera sees them: those on what stands `before` the room (h,w), or
    where the room is never seen behind him, or beside it by NEAR_PX."""
    near = np.ones((2 * NEAR_PX + 1,) * 2, np.uint8)
    bones = [(parent, joint) for joint, parent in enumerate(PARENTS) if parent >= 0]
    ends = joints_m[np.array(bones)]
    points = ends[:, :1] + _ALONG[None, :, None] * (ends[:, 1:] - ends[:, :1])
    on = []
    for camera, shown in zip(cameras, before, strict=True):
        him = np.isin(shown, (BEFORE, CLOTH_OR_SHADOW, UNKNOWN)).astype(np.uint8)
        wide = cv2.dilate(him, near) > 0
        # NaN behind the camera is in no picture
        px = np.nan_to_num(project(camera, points.reshape(-1, 3)) / SCALE, nan=-1e6).astype(int)
        h, w = shown.shape
        seen = ((px >= 0) & (px < (w, h))).all(axis=1)
        x, y = np.clip(px, 0, (w - 1, h - 1)).T
        on.append(seen & wide[y, x])
    return float(np.mean(on))


def _room(shown: Mapping[int, Bytes], times_s: Sequence[float]) -> RoomBackground:
    h, w = shown[0].shape[:2]
    room = RoomBackground(h, w, BackgroundParams())
    numbers = range(0, len(times_s), _ROOM_EVERY)
    of_room = [shown[number] for number in numbers]
    room.set_known(*clip_background(of_room, np.array([times_s[number] for number in numbers])))
    return room


def _smaller(pixels: Bytes) -> Bytes:
    h, w = pixels.shape[:2]
    size = (w // SCALE, h // SCALE)
    return np.asarray(cv2.resize(pixels, size, interpolation=cv2.INTER_AREA), np.uint8)


def _tile(picture: Bytes, camera: Camera, joints_m: Floats | None) -> Bytes:
    """The part of the picture about him, with his skeleton where he is told."""
    out = picture.copy()
    if joints_m is not None:
        draw_skeleton(out, camera, joints_m, SCALE)
    out = out[70:470, 40:320]
    return np.asarray(cv2.resize(out, (140, 200), interpolation=cv2.INTER_AREA), np.uint8)
