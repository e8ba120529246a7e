"""Warm-up of a tracker before the first frame, so that the first frames need not wait."""

from collections.abc import Callable, Mapping

import numpy as np

from mocapd.body.shape import BodyShape
from mocapd.clock import NS_PER_S
from mocapd.tracking.base import Tracker
from mocapd.types import Bytes, Camera, Frame, FrameSet, Rig

STEPS = 8  # the first finds the person, a few confirm it, the rest track it
_PERIOD_NS = NS_PER_S // 30


def rehearse(
    tracker: Tracker,
    shape: BodyShape,
    rig: Rig | None,
    pictures: Mapping[str, Bytes],
    progress: Callable[[int, int], None],
) -> None:
    """Step it through still pictures of a wearer of this shape, and reset it.

    This loads its kernels (or compiles them on the first start on a machine, half a minute) and touches its memory.
    pictures: by camera, one (h,w,3) BGR with the person in it; black for a camera without one, or with one of another
    size. `progress` gets the number of steps done, and of all.
    """
    cameras = rig.cameras if rig else ()
    stills = {camera.name: _picture(camera, pictures.get(camera.name)) for camera in cameras}
    progress(0, STEPS)
    for step in range(STEPS):
        t_ns = step * _PERIOD_NS
        frames = {name: Frame(name, step, t_ns, pixels) for name, pixels in stills.items()}
        shape = tracker.step(FrameSet(t_ns, frames), shape).shape
        progress(step + 1, STEPS)
    tracker.reset()


def _picture(camera: Camera, pixels: Bytes | None) -> Bytes:
    width, height = camera.size_px
    if pixels is None or pixels.shape != (height, width, 3):
        return np.zeros((height, width, 3), np.uint8)
    return pixels
