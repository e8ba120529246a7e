"""How closely the pose filter follows each bone, by what carries the body."""

from dataclasses import astuple, dataclass, replace
from functools import cache

import numpy as np

from mocapd.body.bones import NAMES
from mocapd.body.skeleton import INDEX
from mocapd.tracking.trunk_and_legs import LOWER_BONES
from mocapd.types import Floats, Ints

_LEADS_TO = {
    "Shoulder": "UpperArm", "UpperArm": "LowerArm", "LowerArm": "Hand",
    "UpperLeg": "LowerLeg", "LowerLeg": "Foot", "neck": "head",
}  # fmt: skip
_KIND_OF = {
    "UpperArm": "upper_arm", "LowerArm": "forearm", "Hand": "forearm",
    "UpperLeg": "thigh", "LowerLeg": "shank", "Foot": "shank", "Toes": "shank",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Carrier:
    """cues: names of those that carry the body; shirt: it places trunk and arms; cameras: how many show the body;
    from_one_side: all of them from about the same."""

    cues: str
    shirt: bool
    cameras: int
    from_one_side: bool = False

    @property
    def many(self) -> bool:
        """Whether so many show it that the filter follows closely."""
        return self.cameras >= _MANY


@dataclass(frozen=True, slots=True)
class BoneGains:
    """How the filter gain of a bone depends on joint confidence."""

    sure: float  # confidence for full gain
    doubtful: float  # confidence for the least gain
    least: float
    doubtful_rad_s: float  # greatest angular speed at low confidence
    sure_rad_s: float = 20.0  # the same at full gain
    power: float = 1.0  # exponent of the gain between both; above 1 lowers it
    goes_on: float = 0.75  # share of its speed that remains at the next frame
    noise_rad: float = 0.15  # how far from where it is expected a bone that stays is found at most
    trust_s: float = 0.35  # until an unconfirmed bone is fully trusted again


# without the shirt: at equal confidence an arm's error and jumps are twice those of a leg
_CLOTHES = {
    "trunk": BoneGains(1.6, 0.25, 0.25, 5.4),
    "upper_arm": BoneGains(1.1, 0.0, 0.17, 3.0, power=1.5),
    "forearm": BoneGains(1.1, 0.0, 0.15, 4.0, power=1.5),
    "thigh": BoneGains(2.0, 0.2, 0.43, 9.5),
    "shank": BoneGains(1.6, 0.15, 0.3, 8.5),
}
# three cameras and more tremble a third as much as two: what they find is published nearly as it is, with less lag
_MANY = 3
_MANY_NOISE = 0.5
_CLOTHES_OF_MANY = {
    kind: replace(
        gains,
        sure=gains.doubtful + 0.7 * (gains.sure - gains.doubtful),
        goes_on=0.9,
        noise_rad=_MANY_NOISE * gains.noise_rad,
    )
    for kind, gains in _CLOTHES.items()
}
# the shirt's colours mistake arms less, and its trunk hardly ever: it is found to 0.3 mm and 2 mrad of where it stays
_SHIRT_ARM = BoneGains(
    0.6, 0.0, 0.4, 15.0, sure_rad_s=60.0, goes_on=0.0, noise_rad=0.04, trust_s=0.7
)
_SHIRT_TRUNK = BoneGains(
    1e-6, 0.0, 1.0, 60.0, sure_rad_s=60.0, goes_on=0.0, noise_rad=0.0, trust_s=1e-3
)
# seen from one side the body's depth wanders, and turns its bones
_SHIRT_ARM_FROM_ONE_SIDE = replace(_SHIRT_ARM, noise_rad=0.1)
_SHIRT_TRUNK_FROM_ONE_SIDE = replace(_SHIRT_TRUNK, noise_rad=0.03)
_ROOT_NOISE_M, _SHIRT_ROOT_NOISE_FROM_ONE_SIDE_M = 0.06, 0.01


def _bone_ends() -> tuple[Ints, list[str]]:
    """The joint (J,) at the end of each bone, which sets the confidence of its direction; and each bone's kind."""
    ends, kinds = [], []
    for name in NAMES:
        side = next((s for s in ("left", "right") if name.startswith(s)), "")
        bone = name.removeprefix(side)
        ends.append(INDEX[side + _LEADS_TO.get(bone, bone)])
        kinds.append(_KIND_OF.get(bone, "trunk"))
    return np.array(ends), kinds


END_OF_BONE, _KIND_OF_BONE = _bone_ends()
_ARMS = ("upper_arm", "forearm")
_HEAD = (INDEX["neck"], INDEX["head"])
LOWER = frozenset(LOWER_BONES.tolist())
SHIRT_TRUNK_BONES = np.array(
    [j for j, kind in enumerate(_KIND_OF_BONE) if kind == "trunk" and j not in _HEAD]
)


def gains_of(by: Carrier) -> tuple[Floats, Floats]:
    """Gains (8,J) of each bone for `follow_bones`, and (J,) its trust_s."""
    return _gains_of(by.shirt, by.many, by.from_one_side)


@cache
def _gains_of(by_shirt: bool, by_many: bool, from_one_side: bool) -> tuple[Floats, Floats]:
    rows, of_clothes = [], _CLOTHES_OF_MANY if by_many else _CLOTHES
    for j, kind in enumerate(_KIND_OF_BONE):
        gains = of_clothes[kind]
        if by_shirt and kind in _ARMS:
            gains = _SHIRT_ARM_FROM_ONE_SIDE if from_one_side else _SHIRT_ARM
        elif by_shirt and j in SHIRT_TRUNK_BONES:
            gains = _SHIRT_TRUNK_FROM_ONE_SIDE if from_one_side else _SHIRT_TRUNK
        rows.append(astuple(gains))
    table = np.array(rows, np.float64).T
    return np.ascontiguousarray(table[:8]), table[8].copy()


def root_noise_m(by: Carrier) -> float:
    """How far from where it is expected the root of a body that rests is found at most [m]."""
    if by.shirt:
        return _SHIRT_ROOT_NOISE_FROM_ONE_SIDE_M if by.from_one_side else 0.0
    return _ROOT_NOISE_M * (_MANY_NOISE if by.many else 1.0)
