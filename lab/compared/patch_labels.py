"""Pictures of patch labels that the simulator writes beside some frames of a capture."""

from pathlib import Path

import cv2
import numpy as np

from mocapd.errors import InputError
from mocapd.types import Bytes

_RESTORE = "copy the capture again"


def labelled_frames(capture: Path, video: Path) -> tuple[int, ...]:
    """The frames of a video, camN.mp4, that have a picture of patch labels, camN_FFFFFF.png; in order."""
    stems = (path.stem for path in (capture / "labels").glob(f"{video.stem}_*.png"))
    numbers = (stem.removeprefix(f"{video.stem}_") for stem in stems)
    return tuple(sorted(int(number) for number in numbers if number.isdigit()))


def read_label(capture: Path, video: Path, frame: int) -> Bytes:
    """Patch labels (h,w) of a frame of a video: 0 not shirt, 1..20 the patch at mid exposure. Raises InputError."""
    path = capture / "labels" / f"{video.stem}_{frame:06d}.png"
    try:
        data = np.frombuffer(path.read_bytes(), dtype=np.uint8)
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", str(path), _RESTORE) from None
    label = cv2.imdecode(data, cv2.IMREAD_GRAYSCALE) if data.size else None
    if label is None:
        raise InputError("is damaged or no picture", str(path), _RESTORE)
    return np.asarray(label, dtype=np.uint8)
