"""Body shapes: stature plus a few proportions, each a factor on the mean body of that stature."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from mocapd.body.bones import NAMES
from mocapd.body.skeleton import INDEX, PARENTS, mean_proportions
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
# of head and legs; a shape that leaves them out has 1.0 for each
LOWER_FACTORS = ("thigh_length", "shank_length", "hip_width", "leg_girth", "head_size")
WHOLE_FACTORS = FACTORS + LOWER_FACTORS

# Spread of each factor over adults of one stature: lengths from the spread of the joint centres in
# calib/body_proportions.json; breadths, depths and girths from ANSUR II (2012) coefficients of
# variation at fixed stature, which clothes widen.
FACTOR_SD = np.array([0.04, 0.05, 0.02, 0.07, 0.12, 0.14, 0.18])
# Thigh and shank: the sd of the joints' heights in the same file is 0.05 and 0.03 of their lengths, and
# the leg's length varies by 0.04 at fixed stature (ANSUR II, crotch height). Hips: hip breadth. Girth:
# circumferences of thigh (0.09) and calf (0.08), widened by trousers. Head: its length and breadth.
LOWER_FACTOR_SD = np.array([0.05, 0.04, 0.06, 0.15, 0.04])
# of measured proportions, as a part of the spread over all people
_MEASURED_SPREAD = 0.2


@dataclass(frozen=True, slots=True, eq=False)
class BodyShape:
    """stature_m [m] and factors (N,), 1.0 being the mean body: those of FACTORS, or of WHOLE_FACTORS.

    What is known of the factors: information (N,N), the inverse of their covariance, None for no more than
    what people are like; taught_s: of good tracking that they were learned from [s].
    """

    stature_m: float
    factors: Floats
    information: Floats | None = None
    taught_s: float = 0.0

    def __post_init__(self) -> None:
        if not 0.8 <= self.stature_m <= 2.5:
            raise ConfigError(
                f"a stature of {self.stature_m} m", "stature_m", "give metres, 0.8 to 2.5"
            )
        sizes = ((N_FACTORS,), (len(WHOLE_FACTORS),))
        if self.factors.shape not in sizes or not (self.factors > 0.3).all():
            raise ConfigError(
                f"wanted {N_FACTORS} or {len(WHOLE_FACTORS)} factors above 0.3",
                "body shape",
                "check them",
            )

    def factor(self, name: str) -> float:
        """One factor by its name in WHOLE_FACTORS."""
        i = WHOLE_FACTORS.index(name)
        return float(self.factors[i]) if i < len(self.factors) else 1.0


def mean_shape(stature_m: float) -> BodyShape:
    """The mean body of this stature."""
    return BodyShape(stature_m, np.ones(N_FACTORS))


def measured_shape(stature_m: float, factors: Floats) -> BodyShape:
    """A wearer whose proportions, those of FACTORS, `calibrate.body_shape` has measured."""
    information = np.diag(1.0 / (_MEASURED_SPREAD * FACTOR_SD) ** 2)
    return BodyShape(stature_m, factors, information)


def skeleton_of(shape: BodyShape) -> Skeleton:
    """The T-pose skeleton of a body shape, feet on the floor; longer legs raise all that is above."""
    return Skeleton(NAMES, PARENTS, _rest_m(shape.stature_m, tuple(shape.factors.tolist())).copy())


@lru_cache(maxsize=8)  # several ask in each frame, and a shape seldom changes
def _rest_m(stature_m: float, factors: tuple[float, ...]) -> Floats:
    """(J,3) joints in the T-pose."""
    shape = BodyShape(stature_m, np.array(factors))
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
    # added to what is there, so that factors of 1.0 change no bit
    head, neck = INDEX["head"], INDEX["neck"]
    out[head] += (shape.factor("head_size") - 1.0) * (rest[head] - rest[neck])
    for side in ("left", "right"):
        hip, knee, foot, toes = (
            INDEX[side + bone] for bone in ("UpperLeg", "LowerLeg", "Foot", "Toes")
        )
        longer = (shape.factor("thigh_length") - 1.0) * (rest[knee] - rest[hip])
        out[[knee, foot, toes]] += longer
        lower = (shape.factor("shank_length") - 1.0) * (rest[foot] - rest[knee])
        out[[foot, toes]] += lower
        out[[hip, knee, foot, toes], 0] += (shape.factor("hip_width") - 1.0) * rest[hip, 0]
    out[:, 1] -= longer[1] + lower[1]
    return out


def _descendants(root: str) -> list[int]:
    inside = {INDEX[root]}
    for j, parent in enumerate(PARENTS):
        if parent in inside:
            inside.add(j)
    return sorted(inside)
