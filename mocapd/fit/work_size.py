"""The sizes of the smaller pictures on which bodies are fitted."""

from collections.abc import Sequence

from mocapd.types import Camera

MAX_SIDE_PX = 480  # of a work picture


def image_scales(cameras: Sequence[Camera], work_width_px: int) -> list[int]:
    """By how much each camera's frames are averaged down to work pictures about `work_width_px` wide.

    Pictures that are upright or of odd sizes come out smaller, so that they fit into the buffers.
    """
    return [
        max(1, round(camera.size_px[0] / work_width_px), -(-max(camera.size_px) // MAX_SIDE_PX))
        for camera in cameras
    ]


def work_size(camera: Camera, image_scale: int) -> tuple[int, int]:
    """Width and height of a camera's work picture, both even."""
    return camera.size_px[0] // image_scale & ~1, camera.size_px[1] // image_scale & ~1
