"""Motion as C3D: joints as points, written by ezc3d.

Millimetres; axes as ours, which POINT:X_SCREEN (+X) and POINT:Y_SCREEN (+Y) say. A point of a gap is invalid: the
format's residual of -1.
"""

from pathlib import Path

import numpy as np

from mocapd.exports.c3d.c3d_library import c3d_library
from mocapd.exports.sampled_motion import SampledMotion

MM = 1000.0


def write_c3d(motion: SampledMotion, path: Path) -> None:
    """Write the file. Raises OSError, and UnavailableError without the extra."""
    file = c3d_library().c3d()
    names = list(motion.skeleton.names)
    point = file["parameters"]["POINT"]
    point["RATE"]["value"] = [motion.rate_hz]
    point["UNITS"]["value"] = ["mm"]
    point["LABELS"]["value"] = names
    file.add_parameter("POINT", "X_SCREEN", ["+X"])
    file.add_parameter("POINT", "Y_SCREEN", ["+Y"])
    file["data"]["points"] = np.ones((4, len(names), len(motion.joints_m)))
    file["data"]["points"][:3] = np.moveaxis(motion.joints_m, (0, 1, 2), (2, 1, 0)) * MM
    missing = motion.gap.astype(bool)
    file["data"]["points"][:3, :, missing] = np.nan
    residuals = np.zeros((1, len(names), len(motion.joints_m)))
    residuals[:, :, missing] = -1.0
    file["data"]["meta_points"]["residuals"] = residuals
    try:
        file.write(str(path))
    except (RuntimeError, ValueError) as error:  # of std::ios_base, without a number
        raise OSError(None, str(error)) from None
