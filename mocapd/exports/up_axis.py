"""A motion with +Z up, for programs that do not convert a file's axes; a person at rest then faces -Y."""

from dataclasses import replace

import numpy as np

from mocapd.exports.sampled_motion import SampledMotion
from mocapd.geometry import rotations

_TURN = rotations.exp(np.array([np.pi / 2, 0.0, 0.0]))  # +Y becomes +Z, +Z becomes -Y


def z_up(motion: SampledMotion) -> SampledMotion:
    """The same motion, its T-pose included."""
    back = rotations.inverse(_TURN)
    turned = rotations.multiply(rotations.multiply(_TURN, motion.global_xyzw), back)
    return replace(
        motion,
        skeleton=replace(motion.skeleton, rest_m=rotations.rotate(_TURN, motion.skeleton.rest_m)),
        joints_m=rotations.rotate(_TURN, motion.joints_m),
        global_xyzw=turned,
        up="z",
    )
