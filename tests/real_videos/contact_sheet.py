"""Pictures of a recording side by side, small enough for a page of the docs."""

from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from mocapd.body.bones import NAMES
from mocapd.body.skeleton import PARENTS
from mocapd.geometry.camera_model import project
from mocapd.types import Bytes, Camera, Floats

LEFT, RIGHT, MIDDLE = (90, 220, 60), (60, 60, 255), (60, 220, 255)  # BGR: the person's own sides
_QUALITY = 78


def write_sheet(path: Path, rows: Sequence[Sequence[Bytes]]) -> None:
    """Rows of tiles (h,w,3) of one size as a JPEG."""
    path.parent.mkdir(parents=True, exist_ok=True)
    sheet = np.vstack([np.hstack(list(row)) for row in rows])
    cv2.imwrite(str(path), sheet, [cv2.IMWRITE_JPEG_QUALITY, _QUALITY, cv2.IMWRITE_JPEG_OPTIMIZE, 1])  # fmt: skip


def draw_skeleton(picture: Bytes, camera: Camera, joints_m: Floats, image_scale: float) -> None:
    """The bones of joints (J,3) into a picture that is `image_scale` times smaller than the camera's."""
    px = project(camera, joints_m) / image_scale
    for joint, parent in enumerate(PARENTS):
        if parent < 0 or not np.isfinite(px[[joint, parent]]).all():
            continue
        name = NAMES[joint]
        colour = LEFT if name.startswith("left") else RIGHT if name.startswith("right") else MIDDLE
        ends = [(int(x), int(y)) for x, y in px[[parent, joint]]]
        cv2.line(picture, ends[0], ends[1], colour, 2, cv2.LINE_AA)
