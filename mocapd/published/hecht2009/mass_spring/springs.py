"""The springs between the points: topology, compliance and lengths.

The twenty-four of the paper's figure 1: a bone for each part of a limb and the neck, five in the shoulder girdle, and two
quadrilaterals with their diagonals that share the waist line. Compliance is the give per load [m/N] (Macklin et al.
2016, XPBD): that of a bone is nothing, what hangs on a spring stretches it by compliance times weight, whatever the
time step and the number of iterations.
"""

from dataclasses import dataclass

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
from mocapd.types import Floats, Ints


@dataclass(frozen=True, slots=True)
class Compliances:
    """The give of each kind of spring [m/N]."""

    bone: float = 0.0
    # shoulders play: a centimetre at what a limb that a filter is sure of pulls
    girdle: float = 8e-6
    # under the weight of the legs, 300 N, a trunk stretches by a millimetre or two
    trunk: float = 5e-6
    # Sides and diagonals of a waist that is to bend: the legs' weight stretches it by half a centimetre. With sides more than
    # twice as soft as diagonals the weight would twist it: a twist shortens diagonals and lengthens sides.
    soft_sides: float = 4.5e-5
    soft_diagonals: float = 3e-5


@dataclass(frozen=True, slots=True, eq=False)
class Springs:
    """S springs: ends (S,2) point indices, compliance (S,) [m/N]."""

    ends: Ints
    compliance: Floats

    def lengths_of(self, points_m: Floats) -> Floats:
        """Distances (...,S) between the ends for points (...,16,3)."""
        apart = points_m[..., self.ends[:, 0], :] - points_m[..., self.ends[:, 1], :]
        lengths: Floats = np.sqrt(np.vecdot(apart, apart))
        return lengths


def build_springs(soft_waist: bool, compliances: Compliances) -> Springs:
    """From the head outwards, so that one pass of corrections runs down the body.

    soft_waist: the trunk's lower part gives way: it leans to a side and turns, and the waist's angular limits hold it.
    """
    c = compliances
    sides, diagonals = (c.soft_sides, c.soft_diagonals) if soft_waist else (c.trunk, c.trunk)
    left, right = 0, 1
    both = (left, right)
    # neighbours in this order share no point where it can be so: the processor then corrects several at a time
    table: list[tuple[int, int, float]] = [
        (HEAD, NECK, c.bone),
        *((HEAD, SHOULDER[s], c.girdle) for s in both),
        *((NECK, SHOULDER[s], c.girdle) for s in both),
        (SHOULDER[left], SHOULDER[right], c.girdle),
        *((SHOULDER[s], WAIST[s], c.trunk) for s in both),
        *((SHOULDER[s], WAIST[1 - s], c.trunk) for s in both),
        (WAIST[left], WAIST[right], c.trunk),
        *((SHOULDER[s], ELBOW[s], c.bone) for s in both),
        *((WAIST[s], HIP[s], sides) for s in both),
        *((WAIST[s], HIP[1 - s], diagonals) for s in both),
        *((ELBOW[s], WRIST[s], c.bone) for s in both),
        (HIP[left], HIP[right], c.bone),
        *((HIP[s], KNEE[s], c.bone) for s in both),
        *((KNEE[s], ANKLE[s], c.bone) for s in both),
    ]
    return Springs(np.array([row[:2] for row in table]), np.array([row[2] for row in table]))
