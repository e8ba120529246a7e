"""Small films whose frames carry their own number, and capture folders made of them."""

import json
from pathlib import Path

import cv2
import numpy as np

from mocapd.assets import asset_path
from mocapd.sim.film import Film
from mocapd.sim.scenario import load_scenario
from mocapd.sim.setup_record import SimSetup
from mocapd.sim.world import rig_of
from mocapd.types import Bytes

SIZE_PX = (64, 48)
BITS = 8


def picture(index: int, size_px: tuple[int, int] = SIZE_PX) -> Bytes:
    """A grey picture with `index` as eight black or white columns."""
    width, height = size_px
    image = np.full((height, width, 3), 90, np.uint8)
    column = width // BITS
    for bit in range(BITS):
        image[: height // 2, bit * column : (bit + 1) * column] = 255 if index >> bit & 1 else 0
    return image


def number_of(pixels: Bytes) -> int:
    """The index that a picture carries, also after lossy compression."""
    height, width = pixels.shape[:2]
    column = width // BITS
    bits = [pixels[height // 4, bit * column + column // 2].mean() > 127 for bit in range(BITS)]
    return sum(1 << bit for bit, on in enumerate(bits) if on)


def write_film(
    path: Path,
    frames: int,
    fps_hz: float = 30.0,
    size_px: tuple[int, int] = SIZE_PX,
    code: str = "MJPG",
) -> Path:
    """A film of numbered pictures; Motion JPEG in AVI, where each frame stands alone, unless told otherwise."""
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*code), fps_hz, size_px)
    assert writer.isOpened()
    for index in range(frames):
        writer.write(picture(index, size_px))
    writer.release()
    return path


def write_capture(
    folder: Path,
    frames: tuple[int, ...] = (12, 12),
    time_offsets_s: tuple[float, ...] = (0.0, 0.01),
    size_px: tuple[int, int] = SIZE_PX,
) -> Path:
    """A folder in the capture format, its rig calibrated at SIZE_PX, with a film for each camera."""
    folder.mkdir()
    cameras = []
    for number, (length, offset_s) in enumerate(zip(frames, time_offsets_s, strict=True)):
        write_film(folder / f"cam{number}.avi", length, size_px=size_px)
        cameras.append(
            {
                "name": f"cam{number}",
                "file": f"cam{number}.avi",
                "size": list(SIZE_PX),
                "fps": 30.0,
                "K": [[60.0, 0, 31.5], [0, 60.0, 23.5], [0, 0, 1]],
                "dist": [0.0] * 5,
                "R": np.eye(3).tolist(),
                "t": [0.0, 0.0, 2.0],
                "time_offset_s": offset_s,
            }
        )
    (folder / "rig.json").write_text(json.dumps({"cameras": cameras}))
    (folder / "subject.json").write_text('{"stature_m": 1.72}')
    return folder


def numbered_sim_film(frames: int = 30) -> Film:
    """A film for simulated webcams that shows numbered pictures in place of a rendered scenario."""
    scenario = load_scenario(asset_path("scenarios/living_room.toml"))
    jpegs = tuple(cv2.imencode(".jpg", picture(index))[1].tobytes() for index in range(frames))
    setup = SimSetup(rig_of(scenario), scenario.body.stature_m, scribbles={}, model=())
    return Film(scenario, 0, {one.name: jpegs for one in scenario.cameras}, setup)


def taken_upright(jpeg: bytes) -> bytes:
    """The same JPEG, which says that its camera was held upright: decoders turn it by a quarter."""
    exif = (
        b"\xff\xe1\x00\x22Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0"
    )
    return jpeg[:2] + exif + jpeg[2:]


def smooth_jpeg(size_px: tuple[int, int]) -> bytes:
    """Blurred noise: like a room, it has all colours and no pixel unlike its neighbours."""
    noise = np.random.default_rng(5).integers(0, 256, (size_px[1], size_px[0], 3), np.uint8)
    smooth = cv2.normalize(cv2.GaussianBlur(noise, (0, 0), 6.0), None, 0, 255, cv2.NORM_MINMAX)  # type: ignore[call-overload]
    return cv2.imencode(".jpg", smooth)[1].tobytes()
