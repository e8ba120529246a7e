"""A capture folder as small as one can be: two cameras, ten frames, the shirt's strokes."""

import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from mocapd.shirt.standard_shirt import N_COLOURS

SIZE_PX = (64, 48)
FRAMES = 10


def write_capture(folder: Path) -> Path:
    """Write it; the folder."""
    folder.mkdir()
    cameras = [camera_entry("cam0", -0.5), camera_entry("cam1", 0.5)]
    write_rig(folder, cameras)
    for camera in cameras:
        write_video(folder / camera["file"])
    (folder / "subject.json").write_text('{"stature_m": 1.7}')
    write_stroked(folder / "model" / "0.png", range(1, N_COLOURS + 1))
    return folder


def camera_entry(name: str, x_m: float) -> dict[str, Any]:
    """A camera 3 m in front of the person that looks straight at it."""
    return {
        "name": name,
        "file": f"{name}.mp4",
        "size": list(SIZE_PX),
        "fps": 30.0,
        "K": [[60.0, 0.0, 32.0], [0.0, 60.0, 24.0], [0.0, 0.0, 1.0]],
        "dist": [0.0] * 5,
        "R": [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]],
        "t": [x_m, 1.0, 3.0],
    }


def write_rig(folder: Path, cameras: list[dict[str, Any]]) -> Path:
    """Write rig.json; its path."""
    path = folder / "rig.json"
    path.write_text(json.dumps({"cameras": cameras}))
    return path


def write_video(path: Path, size_px: tuple[int, int] = SIZE_PX, frames: int = FRAMES) -> None:
    """Grey frames that grow brighter."""
    video = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"mp4v"), 30.0, size_px)
    for i in range(frames):
        video.write(np.full((size_px[1], size_px[0], 3), 50 + i, np.uint8))
    video.release()


def write_stroked(path: Path, colours: range) -> None:
    """A picture with a stroke of each of these colours."""
    path.parent.mkdir(exist_ok=True)
    strokes = np.zeros((48, 64), np.uint8)
    for colour in colours:
        strokes[:, 5 * colour] = colour
    cv2.imwrite(str(path), np.full((48, 64, 3), 128, np.uint8))
    cv2.imwrite(str(path.with_name(f"{path.stem}_strokes.png")), strokes)
