"""By how much a pose is beyond its joints' limits."""

import numpy as np

from mocapd.body.arrays import plain
from mocapd.body.joint_limit_kernels import JointLimits, limit_residuals
from mocapd.types import Floats


def soft_limit(limits: JointLimits, local_xyzw: Floats) -> tuple[float, Floats, Floats]:
    """Half the squared excess [rad^2], the excess (G,3) [rad], and its derivative (G,3,3).

    The derivative is by a step of the group's rotation vector in the parent's frame, as
    `posing_kernels.retract` applies it.
    """
    G = len(limits.axis)
    residual, derivative = np.zeros((G, 3)), np.zeros((G, 3, 3))
    limit_residuals(np.asarray(local_xyzw, dtype=float), plain(limits), residual, derivative)
    return 0.5 * float((residual**2).sum()), residual, derivative
