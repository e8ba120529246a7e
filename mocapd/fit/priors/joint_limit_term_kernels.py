"""Joints stay within their limits, softly."""

import numpy as np
from numpy.typing import NDArray

from mocapd.body.joint_limit_kernels import JointLimits, limit_residuals
from mocapd.kernels.decorator import kernel

Array = NDArray[np.float64]


@kernel
def keep_in_limits(
    local_xyzw: Array, limits: JointLimits, information: float, H: Array, b: Array
) -> None:
    """Add information [1/rad^2] of by how much each rotation group of a pose (J,4) is beyond its limits."""
    groups = limits[1].shape[0]
    excess = np.zeros((groups, 3))
    slope = np.zeros((groups, 3, 3))
    limit_residuals(local_xyzw, limits, excess, slope)
    for group in range(groups):
        first = 3 + 3 * group
        for i in range(3):
            if excess[group, i] == 0.0:
                continue
            for p in range(3):
                pull = information * slope[group, i, p]
                b[first + p] -= pull * excess[group, i]
                for q in range(3):
                    H[first + p, first + q] += pull * slope[group, i, q]
