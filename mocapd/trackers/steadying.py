"""What is told follows what was found, the more slowly the less the pictures confirm it.

A limb that the pictures hardly confirm is often wrong, and what is wrong moves as no limb does: from one pose that looks
right to the next. What is well confirmed is told nearly as it was found. A bone that keeps turning is expected to go on, so
that what is held back of each step does not leave it behind (an alpha-beta filter: Kalata 1984, The tracking index).
"""

from collections.abc import Collection
from dataclasses import astuple, dataclass, field, replace
from functools import cache, partial

import numpy as np

from mocapd.body.bones import NAMES
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.clock import nanoseconds, seconds
from mocapd.fit.fit_params import TICK_S
from mocapd.geometry import rotations
from mocapd.trackers.steadying_kernels import follow
from mocapd.types import Floats, Ints, Pose

_LEADS_TO = {
    "Shoulder": "UpperArm", "UpperArm": "LowerArm", "LowerArm": "Hand",
    "UpperLeg": "LowerLeg", "LowerLeg": "Foot", "neck": "head",
}  # fmt: skip
_KINDS = ("trunk", "upper_arm", "forearm", "thigh", "shank")
_KIND_OF = {
    "UpperArm": "upper_arm", "LowerArm": "forearm", "Hand": "forearm",
    "UpperLeg": "thigh", "LowerLeg": "shank", "Foot": "shank", "Toes": "shank",
}  # fmt: skip
_ANEW_S = 0.5  # after a longer gap nothing is left to follow from
_SHORTEST_TICKS = 0.1  # frames of one time are told apart a little


@dataclass(frozen=True, slots=True)
class Following:
    """How much of the way to what was found bones of one kind go in a usual frame."""

    sure: float  # confidence at which it were all of the way; a little is always held back
    doubtful: float  # confidence up to which it is the least
    least: float
    doubtful_rad_s: float  # how fast a bone turns then, at most
    power: float = 1.0  # above 1, what lies between is rather doubtful than sure


@dataclass(frozen=True, slots=True)
class SteadyingParams:
    """How what is told follows. At the same confidence an arm is twice as wrong as a leg, and jumps twice as far."""

    trunk: Following = Following(1.6, 0.25, 0.25, 5.4)
    upper_arm: Following = Following(1.1, 0.0, 0.17, 3.0, power=3.0)
    forearm: Following = Following(1.1, 0.0, 0.15, 4.0, power=3.0)
    thigh: Following = Following(2.5, 0.2, 0.43, 9.5)
    shank: Following = Following(2.0, 0.15, 0.3, 8.5)
    trust_s: float = 0.35  # who was not confirmed at all is fully believed no sooner
    sure_rad_s: float = 20.0
    glide: float = 0.75  # of its speed that a bone keeps to the next frame
    learns: float = 0.65  # of a new speed, at full confidence
    settles_s: float = (
        0.4  # who was just found is told as found: there is nothing better to hold on to
    )

    def with_all(self, bones: Following) -> "SteadyingParams":
        """The same with bones of every kind following like these."""
        return replace(self, trunk=bones, upper_arm=bones, forearm=bones, thigh=bones, shank=bones)


@dataclass(frozen=True, slots=True, eq=False)
class Told:
    """A pose as it was told at t_ns; trust (J,): in each bone's direction, 0..1; since_ns: when it was first found;
    turning_rad_s (J,3), moving_m_s (3,): as it goes on."""

    t_ns: int
    pose: Pose
    trust: Floats
    since_ns: int
    turning_rad_s: Floats = field(default_factory=partial(np.zeros, (N_JOINTS, 3)))
    moving_m_s: Floats = field(default_factory=partial(np.zeros, 3))


def _of_bones() -> tuple[Ints, Ints]:
    """(J,) the joint that each bone leads to, whose confidence tells how well the bone's direction is known; (J,) its place
    in _KINDS."""
    ends, kinds = [], []
    for name in NAMES:
        side = next((s for s in ("left", "right") if name.startswith(s)), "")
        bone = name.removeprefix(side)
        ends.append(INDEX[side + _LEADS_TO.get(bone, bone)])
        kinds.append(_KINDS.index(_KIND_OF.get(bone, "trunk")))
    return np.array(ends), np.array(kinds)


_END_OF_BONE, _KIND_OF_BONE = _of_bones()


@cache
def _following(params: SteadyingParams) -> Floats:
    """(5,J) the numbers of a `Following`, for each bone."""
    kinds = np.array([astuple(getattr(params, kind)) for kind in _KINDS], np.float64)
    return np.ascontiguousarray(kinds[_KIND_OF_BONE].T)


def steadied(
    found: Pose,
    confidence: Floats,
    t_ns: int,
    last: Told | None,
    params: SteadyingParams,
    jumped: Collection[int] = (),
) -> Told:
    """What to tell of a pose that was found with this confidence of its joints (J,), after what was told last; jumped: bones
    that did not move to where they are, but were found to be there."""
    p, trust = params, confidence[_END_OF_BONE]
    gap_s = _ANEW_S if last is None else seconds(t_ns - last.t_ns)
    if last is None or gap_s >= _ANEW_S:
        return Told(t_ns, found, trust, t_ns)
    if t_ns - last.since_ns < nanoseconds(p.settles_s):
        return Told(t_ns, found, trust, last.since_ns)
    trust[list(jumped)] = 0.0
    gap_s = max(gap_s, _SHORTEST_TICKS * TICK_S)
    ticks = gap_s / TICK_S
    trust = np.minimum(trust, last.trust + gap_s / p.trust_s)
    turning = last.turning_rad_s.copy()
    turning[list(jumped)] = 0.0
    told, follows, learned = np.empty((N_JOINTS, 4)), np.empty(N_JOINTS), np.empty(N_JOINTS)
    follow(
        found.quats_xyzw, last.pose.quats_xyzw, trust, _following(p), gap_s, ticks, p.glide, p.learns, p.sure_rad_s,
        turning, told, follows, learned,
    )  # fmt: skip

    moving = p.glide**ticks * last.moving_m_s
    expected_m = last.pose.root_m + gap_s * moving
    root_m = expected_m + follows[0] * (found.root_m - expected_m)
    moving += learned[0] * ((root_m - last.pose.root_m) / gap_s - moving)
    return Told(t_ns, Pose(root_m, told), trust, last.since_ns, turning, moving)


def rehearse() -> None:
    """Tell once for nothing: who is found first must not wait for the kernel to be compiled or loaded."""
    rest = Pose(np.zeros(3), np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1)))
    params, sure = SteadyingParams(settles_s=0.0), np.ones(N_JOINTS)
    steadied(rest, sure, nanoseconds(TICK_S), Told(0, rest, sure, 0), params)


def behind(uncertainty_m: Floats, told_m: Floats, found_m: Floats) -> Floats:
    """How uncertain joints (J,) are, along an axis, that are told beside where they were found (J,3)."""
    out: Floats = np.hypot(uncertainty_m, np.linalg.norm(told_m - found_m, axis=1) / np.sqrt(3.0))
    return out
