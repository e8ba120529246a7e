"""What is published glides to where the tracker found that the body really is, rather than jump."""

from dataclasses import dataclass, replace

import numpy as np

from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.geometry import rotations
from mocapd.types import Floats

_MOST_FRAMES = 8


@dataclass(frozen=True, slots=True, eq=False)
class Residual:
    """By how much what was published was off: root_m (3,), rotvec_rad (J,3) of the local rotations; it is gone
    after `frames`, of which `done` went by."""

    root_m: Floats
    rotvec_rad: Floats
    frames: int
    done: int = 1


def residual(
    root_m: Floats,
    local_xyzw: Floats,
    true_root_m: Floats,
    true_local_xyzw: Floats,
    farthest_m: float,
    step_m: float,
) -> Residual:
    """What was shown (root (3,), local rotations (J,4)) less what is true now; farthest_m: by how much a joint is off;
    step_m: by how much it may be mended in a frame."""
    away = rotations.log(rotations.multiply(local_xyzw, rotations.inverse(true_local_xyzw)))
    frames = int(np.clip(np.ceil(farthest_m / step_m), 1, _MOST_FRAMES))
    return Residual(root_m - true_root_m, away, frames)


def residual_of(
    fitter: Fitter, shown: MotionState, true: MotionState, left: Residual | None, step_m: float
) -> Residual:
    """From what would be shown now, had nothing been found (with what is left of an older residual), to what is true."""
    root, local = shown.root_m, shown.local_xyzw
    if left is not None:
        root, local = blended(root, local, left)
    was, _ = fitter.joints(replace(true, root_m=root, local_xyzw=local))
    now, _ = fitter.joints(true)
    farthest_m = float(np.linalg.norm(was - now, axis=1).max())
    return residual(root, local, true.root_m, true.local_xyzw, farthest_m, step_m)


def blended(root_m: Floats, local_xyzw: Floats, left: Residual) -> tuple[Floats, Floats]:
    """root_m and local_xyzw as they are to be shown."""
    share = 1.0 - left.done / left.frames
    away = rotations.exp(share * left.rotvec_rad)
    return root_m + share * left.root_m, rotations.multiply(away, local_xyzw)


def later(left: Residual) -> Residual | None:
    """A frame on."""
    if left.done + 1 >= left.frames:
        return None
    return Residual(left.root_m, left.rotvec_rad, left.frames, left.done + 1)
