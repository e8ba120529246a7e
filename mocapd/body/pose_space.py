"""What of a body moves and varies: rotation groups with their limits, shape factors, parts, as data.

A pose is three numbers of translation, then a rotation vector for each group in the order of `groups`.
`full_body` begins with the groups and factors of `upper_body`.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache

import numpy as np

from mocapd.body.joint_limit_kernels import JointLimits
from mocapd.body.joint_limits import limits_of
from mocapd.body.shape import FACTOR_SD, FACTORS, LOWER_FACTOR_SD, WHOLE_FACTORS
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.errors import ConfigError
from mocapd.types import Floats, Ints

Group = tuple[str, ...]  # joints that share a bend

SIDES = ("left", "right")
_ARM = ("Shoulder", "UpperArm", "LowerArm")
_LEG = ("UpperLeg", "LowerLeg", "Foot")

_UPPER_GROUPS: tuple[Group, ...] = (
    ("hips",),
    ("spine", "chest", "upperChest"),
    *((side + bone,) for side in SIDES for bone in _ARM),
)
_LOWER_GROUPS: tuple[Group, ...] = (
    ("neck", "head"),
    *((side + bone,) for side in SIDES for bone in _LEG),
)


@dataclass(frozen=True, slots=True)
class BodyPart:
    """A limb: the first joint of each of its groups, which follow each other, and its joints from the trunk
    outwards."""

    groups: tuple[str, ...]
    joints: tuple[str, ...]


@dataclass(frozen=True, slots=True, eq=False)
class PoseSpace:
    """groups: the joints that move, those of one group sharing its bend evenly; factors and factor_sd
    (N,): the shape factors of `body.shape` and their spread; parts by name; whole: whether the legs
    have a surface. Made from those: limits, and per joint its group (-1: does not move) and share."""

    groups: tuple[Group, ...]
    factors: tuple[str, ...]
    factor_sd: Floats
    parts: Mapping[str, BodyPart]
    whole: bool
    limits: JointLimits = field(init=False)
    group_of_joint: Ints = field(init=False)  # (J,)
    share_of_joint: Floats = field(init=False)  # (J,)
    joint_of_group: Ints = field(init=False)  # (G,) the first joint of each group

    def __post_init__(self) -> None:
        group_of_joint = np.full(N_JOINTS, -1, dtype=np.int64)
        share = np.zeros(N_JOINTS)
        for g, names in enumerate(self.groups):
            for name in names:
                group_of_joint[INDEX[name]] = g
                share[INDEX[name]] = 1.0 / len(names)
        object.__setattr__(self, "limits", limits_of(self.groups))
        object.__setattr__(self, "group_of_joint", group_of_joint)
        object.__setattr__(self, "share_of_joint", share)
        object.__setattr__(self, "joint_of_group", np.array([INDEX[n[0]] for n in self.groups]))

    @property
    def n_pose(self) -> int:
        """How many numbers a pose has."""
        return 3 + 3 * len(self.groups)

    @property
    def n_shape(self) -> int:
        """How many shape factors there are."""
        return len(self.factors)

    def group(self, joint: str) -> int:
        """The group that a joint moves with. Raises ConfigError for one that does not move."""
        g = int(self.group_of_joint[INDEX[joint]])
        if g < 0:
            moving = ", ".join(name for names in self.groups for name in names)
            raise ConfigError(f"{joint!r} does not move", "pose space", f"one of: {moving}")
        return g

    def columns(self, part: str) -> slice:
        """The pose parameters of a part."""
        groups = self.parts[part].groups
        first, last = self.group(groups[0]), self.group(groups[-1])
        return slice(3 + 3 * first, 6 + 3 * last)

    def by_group(self, values: Mapping[str, tuple[float, float, float]], default: float) -> Floats:
        """(3 G,): the values that are given for a group's first joint, the default for the others."""
        return np.array([values.get(n[0], (default,) * 3) for n in self.groups]).ravel()


def _arm(side: str) -> BodyPart:
    bones = tuple(side + bone for bone in _ARM)
    return BodyPart(bones, (*bones, side + "Hand"))


def _leg(side: str) -> BodyPart:
    bones = tuple(side + bone for bone in _LEG)
    return BodyPart(bones, (*bones, side + "Toes"))


@cache
def upper_body() -> PoseSpace:
    """Hips, spine and arms. 27 pose parameters, 7 factors."""
    return PoseSpace(
        _UPPER_GROUPS,
        FACTORS,
        FACTOR_SD,
        {f"{side}_arm": _arm(side) for side in SIDES},
        whole=False,
    )


@cache
def full_body() -> PoseSpace:
    """Neck and legs as well. 48 pose parameters, 12 factors."""
    return PoseSpace(
        _UPPER_GROUPS + _LOWER_GROUPS,
        WHOLE_FACTORS,
        np.concatenate([FACTOR_SD, LOWER_FACTOR_SD]),
        {
            **{f"{side}_arm": _arm(side) for side in SIDES},
            "head": BodyPart(("neck",), ("neck", "head")),
            **{f"{side}_leg": _leg(side) for side in SIDES},
        },
        whole=True,
    )
