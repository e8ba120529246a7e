"""Faces as boxes in a grey picture: the cascade over a pyramid, its windows grouped."""

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from mocapd.published.hecht2009.face.lbp_cascade_kernels import WINDOW_PX, CascadeArrays, scan
from mocapd.types import Bytes, Floats

SCALE_STEP = 1.2  # of neighbouring sizes; the cascade bears a tenth either way
_MOST_WINDOWS = 4096
STEP = 2  # of the window, at the cascade's own scale
_PROMISING = 6  # stages that a window passes before its neighbours are scanned: one in fifty does
_NEAR = 0.3  # of the size: windows closer than that, and alike in size, mean the same face
_ALIKE = 1.5


@dataclass(frozen=True, slots=True)
class FaceBox:
    """A square around a face from brow to chin: its middle and side [px]."""

    x_px: float
    y_px: float
    size_px: float


def face_sizes(least_px: float, largest_px: float) -> tuple[float, ...]:
    """Sides of boxes from the least to the largest, a step of the pyramid apart."""
    if largest_px < least_px:
        return ()
    n = int(np.floor(np.log(largest_px / least_px) / np.log(SCALE_STEP) + 1e-9)) + 1
    return tuple(float(least_px * SCALE_STEP**i) for i in range(n))


def face_windows(
    cascade: CascadeArrays,
    grey: Bytes,
    sizes_px: tuple[float, ...],
    region: tuple[int, int, int, int] | None = None,
) -> Floats:
    """Windows (n,3) that the cascade takes for a face: x, y of the middle and side [px].

    grey (h,w); `region` x0, y0, x1, y1 is all that is looked at, clipped to the picture.
    """
    h, w = grey.shape
    x0, y0, x1, y1 = region or (0, 0, w, h)
    x0, y0, x1, y1 = max(x0, 0), max(y0, 0), min(x1, w), min(y1, h)
    found = np.empty((_MOST_WINDOWS, 2), np.int64)
    out = [np.empty((0, 3))]
    for size in sizes_px:
        scale = WINDOW_PX / size
        shape = (round((x1 - x0) * scale), round((y1 - y0) * scale))
        if min(shape) < WINDOW_PX:
            continue
        way = cv2.INTER_AREA if scale < 1.0 else cv2.INTER_LINEAR
        level = cv2.resize(grey[y0:y1, x0:x1], shape, interpolation=way)
        n = scan(cascade, _integral(level), STEP, _PROMISING, found)
        middle = (found[:n] + 0.5 * WINDOW_PX) / scale - 0.5 + (x0, y0)
        out.append(np.column_stack([middle, np.full(n, size)]))
    return np.concatenate(out)


def _integral(grey: NDArray[Any]) -> NDArray[np.int32]:
    return np.asarray(cv2.integral(grey), np.int32)


def group_windows(windows: Floats, least_windows: int) -> tuple[FaceBox, ...]:
    """Faces on which at least so many of the windows (n,3) agree, the surest first."""
    left = np.asarray(windows, dtype=float)
    boxes = []
    while len(left):
        near = _same_face(left[:, None], left[None]).sum(axis=1)
        of = _same_face(left, left[np.argmax(near)])
        x, y, size = left[of].mean(axis=0).tolist()
        if np.count_nonzero(of) < least_windows:
            break
        boxes.append(FaceBox(x, y, size))
        left = left[~of]
    return tuple(boxes)


def faces_near(
    cascade: CascadeArrays, grey: Bytes, x_px: float, y_px: float, size_px: float, reach_px: float,
    least_windows: int,
) -> tuple[FaceBox, ...]:  # fmt: skip
    """Faces of about this size with their middle within reach of a place; scans three sizes."""
    half = 0.5 * SCALE_STEP * size_px + reach_px
    region = (int(x_px - half), int(y_px - half), int(x_px + half) + 2, int(y_px + half) + 2)
    sizes = (size_px / SCALE_STEP, size_px, size_px * SCALE_STEP)
    return group_windows(face_windows(cascade, grey, sizes, region), least_windows)


def _same_face(a: Floats, b: Floats) -> NDArray[np.bool_]:
    size = np.minimum(a[..., 2], b[..., 2])
    near = np.hypot(a[..., 0] - b[..., 0], a[..., 1] - b[..., 1]) < _NEAR * size
    alike = np.maximum(a[..., 2], b[..., 2]) < _ALIKE * size
    out: NDArray[np.bool_] = near & alike
    return out
