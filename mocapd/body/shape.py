"""Body shapes: stature plus a few proportions, each a factor on the mean body of that stature."""

from dataclasses import dataclass

import numpy as np

from mocapd.body.skeleton import INDEX, NAMES, PARENTS, mean_proportions
from mocapd.errors import ConfigError
from mocapd.types import Floats, Skeleton

FACTORS = (
    "torso_length",
    "shoulder_width",
    "upper_arm_length",
    "forearm_length",
    "torso_width",
    "torso_depth",
    "arm_girth",
)
N_FACTORS = len(FACTORS)

# Spread of each factor over adults of one stature: lengths from the spread of the joint centres in
# calib/body_proportions.json; breadths, depths and girths from ANSUR II (2012) coefficients of
# variation at fixed stature, which clothes widen.
FACTOR_SD = np.array([0.04, 0.05, 0.02, 0.07, 0.12, 0.14, 0.18])


@dataclass(frozen=True, slots=True, eq=False)
class BodyShape:
    """stature_m [m] and factors (N_FACTORS,), 1.0 being the mean body; order as in FACTORS."""

    stature_m: float
    factors: Floats

    def __post_init__(self) -> None:
        if not 0.8 <= self.stature_m <= 2.5:
            raise ConfigError(
                f"a stature of {self.stature_m} m", "stature_m", "give metres, 0.8 to 2.5"
            )
        if self.factors.shape != (N_FACTORS,) or not (self.factors > 0.3).all():
            raise ConfigError(f"wanted {N_FACTORS} factors above 0.3", "body shape", "check them")


def mean_shape(stature_m: float) -> BodyShape:
    """The mean body of this stature."""
    return BodyShape(stature_m, np.ones(N_FACTORS))


def skeleton_of(shape: BodyShape) -> Skeleton:
    """The T-pose skeleton of a body shape, feet on the floor at the mean height of the hips."""
    torso, shoulders, upper_arm, forearm = shape.factors[:4]
    rest = mean_proportions() * shape.stature_m
    hips_y = rest[0, 1]
    out = rest.copy()
    above = _descendants("spine")
    out[above, 1] = hips_y + (rest[above, 1] - hips_y) * torso
    for side in ("left", "right"):
        collar, arm, elbow, wrist = (
            INDEX[side + bone] for bone in ("Shoulder", "UpperArm", "LowerArm", "Hand")
        )
        out[[collar, arm], 0] = rest[[collar, arm], 0] * shoulders
        out[elbow] = out[arm] + (rest[elbow] - rest[arm]) * upper_arm
        out[wrist] = out[elbow] + (rest[wrist] - rest[elbow]) * forearm
    return Skeleton(NAMES, PARENTS, out)


def _descendants(root: str) -> list[int]:
    inside = {INDEX[root]}
    for j, parent in enumerate(PARENTS):
        if parent in inside:
            inside.add(j)
    return sorted(inside)
