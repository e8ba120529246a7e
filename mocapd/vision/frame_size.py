"""Frames are of the size that their camera was calibrated with."""

from mocapd.errors import ConfigError
from mocapd.types import Bytes


def check_frame_size(camera: str, pixels: Bytes, size_px: tuple[int, int]) -> None:
    """Raises ConfigError when pixels (h,w,3) of this camera are not of its calibration's size, width and height."""
    h, w = pixels.shape[:2]
    if (w, h) != size_px:
        raise ConfigError(
            f"delivers {w}x{h}, its calibration is for {size_px[0]}x{size_px[1]}",
            f"camera {camera!r}",
            "set that size, or calibrate again",
        )
