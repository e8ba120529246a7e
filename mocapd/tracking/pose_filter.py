"""The one filter of poses over time: bones follow what was found, and what was found elsewhere is approached, not jumped to.

A limb that the pictures hardly confirm is often wrong, and what is wrong moves as no limb does: from one pose that looks
right to the next. What is well confirmed is published nearly as it was found. A bone that keeps turning is expected to go on,
so that what is held back of each step does not leave it behind (an alpha-beta filter: Kalata 1984, The tracking index).
What goes to and fro about where a bone is expected is noise and is followed little, so that somebody who stands still does
not tremble; what goes one way is motion. Where the cues that carry a body change, or an arm was found elsewhere, the
difference goes away at a bounded speed.

A bone that turns steadily is published behind where it is found, since less than all of its speed is expected to go on. With
the share f of the way that it follows, the share l of a new speed that it learns and the share g that it keeps to the next
frame, which is dt away, it is behind by dt (1/f - 1) (1 - g) / (1 - g + g l): the filter's lag. The difference that goes
away after a change of cues moves along with the body, and adds no lag.
"""

from collections.abc import Collection
from dataclasses import astuple, dataclass, field, replace
from functools import cache, partial

import numpy as np

from mocapd.body.bones import NAMES
from mocapd.body.skeleton import INDEX, N_JOINTS, joint_positions
from mocapd.clock import nanoseconds, seconds
from mocapd.fit.fit_params import TICK_S
from mocapd.geometry import rotations
from mocapd.tracking.pose_filter_kernels import follow_bones, moving_share
from mocapd.tracking.trunk_and_legs import LOWER_BONES
from mocapd.types import Floats, Ints, Pose, Skeleton

_LEADS_TO = {
    "Shoulder": "UpperArm", "UpperArm": "LowerArm", "LowerArm": "Hand",
    "UpperLeg": "LowerLeg", "LowerLeg": "Foot", "neck": "head",
}  # fmt: skip
_KIND_OF = {
    "UpperArm": "upper_arm", "LowerArm": "forearm", "Hand": "forearm",
    "UpperLeg": "thigh", "LowerLeg": "shank", "Foot": "shank", "Toes": "shank",
}  # fmt: skip
_ANEW_S = 0.5  # after a longer gap nothing is left to follow from
_SHORTEST_TICKS = 0.1  # frames of one time are told apart a little
_LEAST_STEP_M = 0.01  # of a joint in a frame, however short
_HALVINGS = 10  # of what is left: the way of a metre is known to a millimetre


@dataclass(frozen=True, slots=True)
class Following:
    """How much of the way to what was found a bone goes in a usual frame."""

    sure: float  # confidence at which it were all of the way; a little is always held back
    doubtful: float  # confidence up to which it is the least
    least: float
    doubtful_rad_s: float  # how fast the bone turns then, at most
    sure_rad_s: float = 20.0  # and where it is sure
    power: float = 1.0  # above 1, what lies between is rather doubtful than sure
    goes_on: float = 0.75  # share of its speed that it keeps to the next frame
    noise_rad: float = 0.15  # how far from where it is expected a bone that stays is found at most
    trust_s: float = 0.35  # who was not confirmed at all is fully believed no sooner


# without the shirt: at the same confidence an arm is twice as wrong as a leg, and jumps twice as far
_CLOTHES = {
    "trunk": Following(1.6, 0.25, 0.25, 5.4),
    "upper_arm": Following(1.1, 0.0, 0.17, 3.0, power=3.0),
    "forearm": Following(1.1, 0.0, 0.15, 4.0, power=3.0),
    "thigh": Following(2.5, 0.2, 0.43, 9.5),
    "shank": Following(2.0, 0.15, 0.3, 8.5),
}
# the shirt's colours mistake arms less, and its trunk hardly ever: it is found to 0.3 mm and 2 mrad of where it stays
_SHIRT_ARM = Following(
    0.6, 0.0, 0.4, 15.0, sure_rad_s=60.0, goes_on=0.0, noise_rad=0.04, trust_s=0.7
)
_SHIRT_TRUNK = Following(
    1e-6, 0.0, 1.0, 60.0, sure_rad_s=60.0, goes_on=0.0, noise_rad=0.0, trust_s=1e-3
)


@dataclass(frozen=True, slots=True)
class PoseFilterParams:
    """learns: of a new speed, at full confidence; noise_m: how far from where it is expected the root of a body that stays is
    found at most, without the shirt; settles_s: a body that was just found is published as found, for so long [s]. An offset
    goes away within approach_s [s], of any joint at approach_m_s at least, at any frame rate, and never by more than step_m
    in a frame. A joint that moves faster than leap_m_s, within approach_s of a change, has settled elsewhere."""

    learns: float = 0.65
    noise_m: float = 0.06
    settles_s: float = 0.4
    approach_s: float = 0.25
    approach_m_s: float = 1.5
    step_m: float = 0.09
    leap_m_s: float = 3.0


@dataclass(frozen=True, slots=True, eq=False)
class _Filtered:
    """A pose as published at t_ns, of a body carried by `carrier`; smooth: without the offset; trust (J,): in each bone's
    direction, 0..1; since_ns: when the body was first found; turning_rad_s (J,3), moving_m_s (3,): as it goes on; lag_s: see
    `PoseFilter.lag_s`; memory (1+J,5): of `moving_share`, for the root and each bone."""

    t_ns: int
    carrier: str
    pose: Pose
    smooth: Pose
    trust: Floats
    since_ns: int
    turning_rad_s: Floats = field(default_factory=partial(np.zeros, (N_JOINTS, 3)))
    moving_m_s: Floats = field(default_factory=partial(np.zeros, 3))
    lag_s: float = 0.0
    memory: Floats = field(default_factory=partial(np.zeros, (1 + N_JOINTS, 5)))


@dataclass(frozen=True, slots=True, eq=False)
class _Offset:
    """What was published, off what is known: root_m (3,), rotvec_rad (J,3) of the global rotations; `share` is left of it;
    speed_m_s: at which the joints approach."""

    root_m: Floats
    rotvec_rad: Floats
    speed_m_s: float
    share: float = 1.0

    def of(self, pose: Pose, share: float) -> Pose:
        """The pose that is this share of the way off a known one."""
        turned = rotations.multiply(rotations.exp(share * self.rotvec_rad), pose.quats_xyzw)
        return Pose(pose.root_m + share * self.root_m, rotations.canonical(turned))


class PoseFilter:
    """Remembers what was published last, and what is left of an offset."""

    def __init__(self, params: PoseFilterParams | None = None) -> None:
        self._params = params if params is not None else PoseFilterParams()
        self.reset()

    def rehearse(self, skeleton: Skeleton) -> None:
        """Filter once for nothing: who is found first must not wait for the kernel to be compiled or loaded."""
        rest = Pose(np.zeros(3), np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1)))
        for frame in range(2):
            self.step(rest, np.ones(N_JOINTS), frame, "shirt", True, skeleton)
        self.reset()

    def reset(self) -> None:
        """Nobody was published."""
        self._last: _Filtered | None = None
        self._before: Pose | None = None  # published before that
        self._offset: _Offset | None = None
        self._changed_ns: int | None = None  # when other cues began to carry the body
        self._way_m: Floats | None = (
            None  # of each joint (J,3), since the frame before, while that is asked
        )

    @property
    def lag_s(self) -> float:
        """How far a body that moves steadily is published behind where it was found, in the last step [s]: the mean over
        the bones, each by the trust in it. 0 while poses are published as found."""
        return 0.0 if self._last is None else self._last.lag_s

    def step(
        self,
        found: Pose,
        confidence: Floats,
        t_ns: int,
        carrier: str,
        by_shirt: bool,
        skeleton: Skeleton,
        jumped: Collection[int] = (),
        legs_since_ns: int | None = None,
    ) -> Pose:
        """What to publish of a pose that was found with this confidence of its joints (J,).

        carrier: which cues carry it; by_shirt: whether that is the shirt for trunk and arms; jumped: bones that did not move
        to where they are, but were found to be there; legs_since_ns: when legs and head were first found.
        """
        p, last = self._params, self._last
        if last is None or seconds(t_ns - last.t_ns) >= _ANEW_S:
            self.reset()
            trust = confidence[_END_OF_BONE]
            self._last = _Filtered(t_ns, carrier, found, found, trust, t_ns)
            return found
        expected = self._expected(last)
        if last.carrier != carrier:
            self._changed_ns, self._way_m = t_ns, None
        now = self._followed(
            found, confidence, t_ns, carrier, by_shirt, last, jumped, legs_since_ns
        )
        leaps = self._changed_ns is not None and self._leaps(now, last, skeleton)
        arms_jumped = by_shirt and not set(jumped) <= _LOWER
        if last.carrier != carrier or arms_jumped or leaps:
            self._offset = _offset_of(expected, now.smooth, skeleton, p)
        if self._offset is not None:
            step_m = min(
                p.step_m, max(self._offset.speed_m_s * seconds(t_ns - last.t_ns), _LEAST_STEP_M)
            )
            self._offset = _lessened(now.smooth, self._offset, skeleton, step_m)
        if self._offset is not None:
            now = replace(now, pose=self._offset.of(now.smooth, self._offset.share))
        elif self._changed_ns is not None and t_ns - self._changed_ns > nanoseconds(p.approach_s):
            self._changed_ns = None
        self._before, self._last = last.pose, now
        return now.pose

    def _expected(self, last: _Filtered) -> Pose:
        """What was published last, moved on as it moved."""
        if self._before is None:
            return last.pose
        turn = rotations.multiply(last.pose.quats_xyzw, rotations.inverse(self._before.quats_xyzw))
        quats = rotations.canonical(rotations.multiply(turn, last.pose.quats_xyzw))
        return Pose(2.0 * last.pose.root_m - self._before.root_m, quats)

    def _leaps(self, now: _Filtered, last: _Filtered, skeleton: Skeleton) -> bool:
        """Whether a joint went otherwise than a moment ago, by more than a person can."""
        p, gap_s = self._params, seconds(now.t_ns - last.t_ns)
        if now.carrier != last.carrier:
            return False
        way_m = joint_positions(skeleton, now.smooth) - joint_positions(skeleton, last.smooth)
        before_m, self._way_m = self._way_m, way_m
        if before_m is None:
            return False
        most_m = max(p.step_m, p.leap_m_s * gap_s)
        return bool(np.linalg.norm(way_m - before_m, axis=1).max() > most_m)

    def _followed(
        self,
        found: Pose,
        confidence: Floats,
        t_ns: int,
        carrier: str,
        by_shirt: bool,
        last: _Filtered,
        jumped: Collection[int],
        legs_since_ns: int | None,
    ) -> _Filtered:
        p, trust = self._params, confidence[_END_OF_BONE]
        following, trust_s = _following(by_shirt)
        if by_shirt:
            trust[_SHIRT_TRUNK_BONES] = 1.0
        elif t_ns - last.since_ns < nanoseconds(p.settles_s):
            return _Filtered(t_ns, carrier, found, found, trust, last.since_ns)
        if last.carrier != carrier:  # the offset begins at what the new cues found
            return _Filtered(
                t_ns,
                carrier,
                found,
                found,
                trust,
                last.since_ns,
                last.turning_rad_s,
                last.moving_m_s,
            )
        trust[list(jumped)] = 0.0
        gap_s = max(seconds(t_ns - last.t_ns), _SHORTEST_TICKS * TICK_S)
        ticks = gap_s / TICK_S
        trust = np.minimum(trust, last.trust + gap_s / trust_s)
        turning = last.turning_rad_s.copy()
        turning[list(jumped)] = 0.0
        memory = last.memory.copy()
        quats, follows, learned = np.empty((N_JOINTS, 4)), np.empty(N_JOINTS), np.empty(N_JOINTS)
        follow_bones(
            found.quats_xyzw, last.smooth.quats_xyzw, trust, following, gap_s, ticks, p.learns, memory[1:], turning,
            quats, follows, learned,
        )  # fmt: skip
        moving = following[6, 0] ** ticks * last.moving_m_s
        expected_m = last.smooth.root_m + gap_s * moving
        way_m = found.root_m - expected_m
        speed_m_s = float(np.linalg.norm(last.moving_m_s))
        noise_m = 0.0 if by_shirt else p.noise_m
        share = follows[0] * moving_share(way_m, speed_m_s, memory[0], ticks, noise_m)
        root_m = expected_m + share * way_m
        moving += learned[0] * ((root_m - last.smooth.root_m) / gap_s - moving)
        if legs_since_ns is not None and t_ns - legs_since_ns < nanoseconds(p.settles_s):
            quats[LOWER_BONES], turning[LOWER_BONES] = found.quats_xyzw[LOWER_BONES], 0.0
        pose = Pose(root_m, quats)
        lag_s = _lag_s(gap_s, follows, learned, following[6] ** ticks, trust)
        return _Filtered(
            t_ns, carrier, pose, pose, trust, last.since_ns, turning, moving, lag_s, memory
        )


def _lag_s(gap_s: float, follows: Floats, learned: Floats, kept: Floats, trust: Floats) -> float:
    """See the module; follows, learned, kept (J,): f, l and g of each bone."""
    lags_s = gap_s * (1.0 / follows - 1.0) * (1.0 - kept) / (1.0 - kept + kept * learned)
    return float(np.average(lags_s, weights=trust + 1e-6))


def _offset_of(
    published: Pose, known: Pose, skeleton: Skeleton, params: PoseFilterParams
) -> _Offset:
    turn = rotations.multiply(published.quats_xyzw, rotations.inverse(known.quats_xyzw))
    way_m = joint_positions(skeleton, published) - joint_positions(skeleton, known)
    farthest_m = float(np.linalg.norm(way_m, axis=1).max())
    speed_m_s = max(farthest_m / params.approach_s, params.approach_m_s)
    return _Offset(published.root_m - known.root_m, rotations.log(turn), speed_m_s)


def _lessened(known: Pose, offset: _Offset, skeleton: Skeleton, step_m: float) -> _Offset | None:
    """As much less as no joint needs more than step_m for, beside its own motion; None when nothing is left."""
    before_m = joint_positions(skeleton, offset.of(known, offset.share))

    def is_near(share: float) -> bool:
        joints_m = joint_positions(skeleton, offset.of(known, share))
        return bool((np.linalg.norm(joints_m - before_m, axis=1) <= step_m).all())

    if is_near(0.0):
        return None
    too_little, enough = 0.0, offset.share
    for _ in range(_HALVINGS):
        middle = 0.5 * (too_little + enough)
        if is_near(middle):
            enough = middle
        else:
            too_little = middle
    return replace(offset, share=enough)


def _of_bones() -> tuple[Ints, list[str]]:
    """(J,) the joint that each bone leads to, whose confidence says how well the bone's direction is known; and each
    bone's kind."""
    ends, kinds = [], []
    for name in NAMES:
        side = next((s for s in ("left", "right") if name.startswith(s)), "")
        bone = name.removeprefix(side)
        ends.append(INDEX[side + _LEADS_TO.get(bone, bone)])
        kinds.append(_KIND_OF.get(bone, "trunk"))
    return np.array(ends), kinds


_END_OF_BONE, _KIND_OF_BONE = _of_bones()
_ARMS = ("upper_arm", "forearm")
_HEAD = (INDEX["neck"], INDEX["head"])
_LOWER = frozenset(LOWER_BONES.tolist())
_SHIRT_TRUNK_BONES = np.array(
    [j for j, kind in enumerate(_KIND_OF_BONE) if kind == "trunk" and j not in _HEAD]
)


@cache
def _following(by_shirt: bool) -> tuple[Floats, Floats]:
    """(8,J) what `follow_bones` needs of a `Following`, for each bone; and (J,) its trust_s."""
    rows = []
    for j, kind in enumerate(_KIND_OF_BONE):
        one = _CLOTHES[kind]
        if by_shirt and kind in _ARMS:
            one = _SHIRT_ARM
        elif by_shirt and j in _SHIRT_TRUNK_BONES:
            one = _SHIRT_TRUNK
        rows.append(astuple(one))
    table = np.array(rows, np.float64).T
    return np.ascontiguousarray(table[:8]), table[8].copy()
