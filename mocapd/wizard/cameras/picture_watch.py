"""Statistics of every frame for judging light, locks and delivery: mean colour, brightness of the rows, and gaps."""

import mocapd.capture.environment  # noqa: F401  isort: skip  before cv2

import threading
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass

import cv2
import numpy as np

from mocapd.clock import NS_PER_S
from mocapd.pipeline.bundler import CameraCounts
from mocapd.types import Bytes, Floats, Frame, Ints

_KEPT = 90  # frames of a camera
_ROWS = 48
_COLUMNS = 64
_BGR_TO_LUMA = np.array([0.114, 0.587, 0.299])


@dataclass(frozen=True, slots=True, eq=False)
class Recent:
    """The last frames of one camera, oldest first: t_ns (n,); seq (n,), the camera's own count; rows (n,r), mean luma
    0..255 of some 50 rows spread over the picture; bgr (n,3), mean colour 0..255."""

    t_ns: Ints
    seq: Ints
    rows: Floats
    bgr: Floats

    @property
    def brightness(self) -> float:
        """Mean luma 0..255, of one frame at least."""
        return float((self.bgr @ _BGR_TO_LUMA).mean())

    @property
    def warmth(self) -> float:
        """Red over blue, of one frame at least."""
        blue, _green, red = self.bgr.mean(axis=0)
        return float((red + 1.0) / (blue + 1.0))

    def since(self, t_ns: int) -> "Recent":
        """The frames after that instant."""
        later = self.t_ns > t_ns
        return Recent(self.t_ns[later], self.seq[later], self.rows[later], self.bgr[later])

    def counts(self, asked_hz: float) -> CameraCounts:
        """These frames, and those that the camera counted between them and that never arrived. `seq` may come from an
        untrusted camera node, so a gap counts at most the frames that fit into its time; it restarts when a camera is
        reopened."""
        most = np.floor(np.diff(self.t_ns) / NS_PER_S * asked_hz).astype(np.int64)
        lost = int(np.clip(np.diff(self.seq) - 1, 0, np.maximum(most, 0)).sum())
        return CameraCounts(received=len(self.t_ns), used=len(self.t_ns), late=0, lost=lost)


def row_means(pixels: Bytes) -> tuple[Floats, Floats]:
    """Mean luma (r,) of rows spread over a BGR picture (h,w,3), and its mean colour (3,)."""
    height, width = pixels.shape[:2]
    thin = pixels[:: max(1, height // _ROWS), :: max(1, width // _COLUMNS)]
    colours = cv2.reduce(np.ascontiguousarray(thin), 1, cv2.REDUCE_AVG, dtype=cv2.CV_32F)[:, 0]
    means = np.asarray(colours, dtype=np.float64)
    return means @ _BGR_TO_LUMA, means.mean(axis=0)


class PictureWatch:
    """A FrameHub subscriber; `put` runs in the capture threads, the rest anywhere."""

    def __init__(self, cameras: Iterable[str]) -> None:
        self._lock = threading.Lock()  # guards what follows
        self._frames: dict[str, deque[tuple[int, int, Floats, Floats]]] = {
            name: deque(maxlen=_KEPT) for name in cameras
        }

    def put(self, frame: Frame) -> None:
        rows, bgr = row_means(frame.pixels)
        with self._lock:
            own = self._frames.get(frame.camera)
            if own is None:
                return
            if own and own[-1][2].shape != rows.shape:
                own.clear()  # reopened with another size
            own.append((frame.t_ns, frame.seq, rows, bgr))

    def recent(self, camera: str) -> Recent:
        """The stored frames, of about the last three seconds."""
        with self._lock:
            own = list(self._frames[camera])
        if not own:
            none = np.zeros(0, np.int64)
            return Recent(none, none, np.zeros((0, 1)), np.zeros((0, 3)))
        times, seqs, rows, colours = zip(*own, strict=True)
        return Recent(
            np.array(times, np.int64), np.array(seqs, np.int64), np.array(rows), np.array(colours)
        )
