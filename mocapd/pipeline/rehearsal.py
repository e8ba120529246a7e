"""Before the first frame: let the tracker do its work once, so that the first frames need not wait."""

from collections.abc import Callable, Mapping

import numpy as np

from mocapd.body.shape import BodyShape
from mocapd.clock import NS_PER_S
from mocapd.tracking.base import Tracker
from mocapd.types import Bytes, Camera, Frame, FrameSet, Rig

STEPS = 8  # the person is found in the first, believed in a few, followed in the rest
_PERIOD_NS = NS_PER_S // 30


def rehearse(
    tracker: Tracker,
    shape: BodyShape,
    rig: Rig | None,
    pictures: Mapping[str, Bytes],
    tell: Callable[[int, int], None],
) -> None:
    """Step it through still pictures, of a wearer of this shape, and reset it.

    Its kernels are compiled if that never happened on this machine, which takes half a minute, else
    loaded, and its memory is touched. pictures: by camera, one (h,w,3) BGR with the person in it;
    without one, or with one of another size than the camera's, it is black. `tell` hears of steps
    done, in all.
    """
    cameras = rig.cameras if rig else ()
    seen = {camera.name: _picture(camera, pictures.get(camera.name)) for camera in cameras}
    tell(0, STEPS)
    for step in range(STEPS):
        t_ns = step * _PERIOD_NS
        frames = {name: Frame(name, step, t_ns, pixels) for name, pixels in seen.items()}
        shape = tracker.step(FrameSet(t_ns, frames), shape).shape
        tell(step + 1, STEPS)
    tracker.reset()


def _picture(camera: Camera, pixels: Bytes | None) -> Bytes:
    width, height = camera.size_px
    if pixels is None or pixels.shape != (height, width, 3):
        return np.zeros((height, width, 3), np.uint8)
    return pixels
