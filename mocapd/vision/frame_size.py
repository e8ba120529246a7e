"""Frames are of the size that their camera was calibrated with."""

from mocapd.errors import ConfigError
from mocapd.types import Frame


def check_frame_size(frame: Frame, size_px: tuple[int, int]) -> None:
    """Raises ConfigError when a frame is not of its camera's calibrated size, width and height."""
    w, h = frame.size_px
    if (w, h) != size_px:
        raise ConfigError(
            f"delivers {w}x{h}, its calibration is for {size_px[0]}x{size_px[1]}",
            f"camera {frame.camera!r}",
            "set that size, or calibrate again",
        )
