"""Compares lenses in the joint solution with separate solutions, which time errors cannot affect."""

from collections.abc import Mapping

import numpy as np

from mocapd.calibrate.intrinsics.intrinsics import Intrinsics
from mocapd.errors import ConfigError
from mocapd.types import Rig

_SIGMAS = 5.0
_LEAST = 0.03  # part of the focal length that lens models differ by anyway


def refuse_contradicted_lenses(rig: Rig, alone: Mapping[str, Intrinsics]) -> None:
    """Raises ConfigError for the camera with the largest contradiction of focal lengths."""
    worst: tuple[float, str] | None = None
    for camera in rig.cameras:
        intrinsics = alone[camera.name]
        off = abs(float(np.log(camera.K[0, 0] / intrinsics.K[0, 0])))
        share = off / max(_LEAST, _SIGMAS * intrinsics.focal_deviation)
        if share > 1.0 and (worst is None or share > worst[0]):
            worst = share, camera.name
    if worst is None:
        return
    name = worst[1]
    intrinsics = alone[name]
    joint_px = next(camera.K[0, 0] for camera in rig.cameras if camera.name == name)
    raise ConfigError(
        f"its own pictures give a focal length of {intrinsics.K[0, 0]:.0f} px "
        f"(known to {100.0 * intrinsics.focal_deviation:.1f} %), all cameras together {joint_px:.0f} px",
        name,
        "see that frames of one index are of one moment, that no camera moves while the board is shown, and that "
        "the board is as large as given",
    )
