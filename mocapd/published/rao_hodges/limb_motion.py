"""Largest change per frame and range of each angle, learned by `lab.rao_hodges.learn_motion`.

Of 75 clips of real motion at 60 Hz, both sides together. The largest step "after discounting for the noise" is the
99.5th percentile: what is above it are jumps between joined cuts and the flips of angles near a singularity.
"""

import numpy as np

from mocapd.published.rao_hodges.annealing import SearchSpace
from mocapd.published.rao_hodges.limb_chain import LimbChain

RATE_HZ = 60.0
STEP_DEG = {
    "hip_z": 7.6, "hip_y": 5.3, "hip_x": 6.6, "knee_x": 7.3, "ankle_x": 10.9,
    "shoulder_x": 14.2, "shoulder_y": 10.1, "shoulder_z": 12.0, "elbow": 7.9,
}  # fmt: skip
# Hinges only: hips and shoulders go all around. Percentiles 0.5 and 99.5.
LIMITS_DEG = {"knee_x": (0.0, 152.0), "ankle_x": (-83.0, 33.0), "elbow": (5.0, 132.0)}


def search_space(chain: LimbChain, dt_s: float = 1.0 / RATE_HZ) -> SearchSpace:
    """The top layer's noise is a third of each angle's largest step, in proportion to the time between frames."""
    steps = np.radians([STEP_DEG[kind] for kind in chain.kinds])
    limits = np.radians([LIMITS_DEG.get(kind, (-np.inf, np.inf)) for kind in chain.kinds])
    return SearchSpace(steps / 3.0 * (dt_s * RATE_HZ), limits[:, 0], limits[:, 1])
