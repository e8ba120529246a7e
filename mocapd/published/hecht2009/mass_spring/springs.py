"""The springs between the points: topology, compliance and lengths.

The twenty-four of the paper's figure 1: a bone for each part of a limb and the neck, five in the shoulder girdle, and two
quadrilaterals with their diagonals that share the waist line. Compliance is the give per load [m/N] (Macklin et al.
2016, XPBD): that of a bone is nothing, what hangs on a spring stretches it by compliance times weight, whatever the
time step and the number of iterations.
"""

import numpy as np

from mocapd.published.hecht2009.mass_spring.body_points import (
    ANKLE,
    ELBOW,
    HEAD,
    HIP,
    KNEE,
    NECK,
    SHOULDER,
    WAIST,
    WRIST,
)
from mocapd.types import Floats

# the give of each kind of spring [m/N]
_BONE = 0.0
# shoulders play: a centimetre at what a limb that a filter is sure of pulls
_GIRDLE = 8e-6
# under the weight of the legs, 300 N, a trunk stretches by a millimetre or two
_TRUNK = 5e-6

_LEFT, _RIGHT = _BOTH = 0, 1
# From the head outwards, so that one pass of corrections runs down the body.
# Neighbours in this order share no point where it can be so: the processor then corrects several at a time.
_TABLE: tuple[tuple[int, int, float], ...] = (
    (HEAD, NECK, _BONE),
    *((HEAD, SHOULDER[s], _GIRDLE) for s in _BOTH),
    *((NECK, SHOULDER[s], _GIRDLE) for s in _BOTH),
    (SHOULDER[_LEFT], SHOULDER[_RIGHT], _GIRDLE),
    *((SHOULDER[s], WAIST[s], _TRUNK) for s in _BOTH),
    *((SHOULDER[s], WAIST[1 - s], _TRUNK) for s in _BOTH),
    (WAIST[_LEFT], WAIST[_RIGHT], _TRUNK),
    *((SHOULDER[s], ELBOW[s], _BONE) for s in _BOTH),
    *((WAIST[s], HIP[s], _TRUNK) for s in _BOTH),
    *((WAIST[s], HIP[1 - s], _TRUNK) for s in _BOTH),
    *((ELBOW[s], WRIST[s], _BONE) for s in _BOTH),
    (HIP[_LEFT], HIP[_RIGHT], _BONE),
    *((HIP[s], KNEE[s], _BONE) for s in _BOTH),
    *((KNEE[s], ANKLE[s], _BONE) for s in _BOTH),
)
ENDS = np.array([row[:2] for row in _TABLE])  # (S,2) point indices
COMPLIANCE = np.array([row[2] for row in _TABLE])  # (S,) [m/N]


def spring_lengths(points_m: Floats) -> Floats:
    """Distances (...,S) between the ends for points (...,16,3) [m]."""
    apart = points_m[..., ENDS[:, 0], :] - points_m[..., ENDS[:, 1], :]
    lengths: Floats = np.sqrt(np.vecdot(apart, apart))
    return lengths
