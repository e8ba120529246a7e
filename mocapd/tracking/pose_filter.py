"""The temporal filter of published poses: an alpha-beta filter on each bone's rotation (Kalata 1984, The tracking index).

The gain falls with joint confidence, since a limb that the pictures hardly confirm is often wrong and jumps between
plausible poses. Bones of high confidence are published nearly as measured. Noise alternates about the prediction and gets
a low gain; motion keeps its direction. After a change of the carrying cues, or of an arm found elsewhere, a correction
blends the published pose towards the new estimate at bounded speed.

A bone in steady rotation is published with a lag, since the filter keeps less than its full speed. With gain f on the
rotation, gain l on the speed and share g of the speed that remains after a frame interval dt, the lag is
dt (1/f - 1) (1 - g) / (1 - g + g l). The correction moves along with the body and adds no lag.
"""

from collections.abc import Collection
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from mocapd.body.skeleton import N_JOINTS, joint_positions
from mocapd.clock import nanoseconds, seconds
from mocapd.fit.fit_params import TICK_S
from mocapd.geometry import rotations
from mocapd.tracking.bone_gains import (
    END_OF_BONE,
    LOWER,
    SHIRT_TRUNK_BONES,
    Carrier,
    gains_of,
    root_noise_m,
)
from mocapd.tracking.pose_filter_kernels import follow_bones, moving_share
from mocapd.tracking.trunk_and_legs import LOWER_BONES
from mocapd.types import Floats, Pose, Skeleton

_RESET_AFTER_S = 0.5  # a longer gap resets the filter
_SHORTEST_TICKS = 0.1  # least time step, also between frames of equal time
_LEAST_STEP_M = 0.01  # of a joint in a frame, however short
_HALVINGS = 10  # bisection steps: resolves a step of a metre to a millimetre


@dataclass(frozen=True, slots=True)
class PoseFilterParams:
    """learns: speed gain at full confidence; settles_s: a new body is published unfiltered for this long [s].

    A correction ends within approach_s [s]; its joints move at approach_m_s or faster at any frame rate, but by step_m at
    most in a frame. A joint faster than leap_m_s within approach_s of a change has moved to another pose.
    """

    learns: float = 0.65
    settles_s: float = 0.4
    approach_s: float = 0.25
    approach_m_s: float = 1.5
    step_m: float = 0.09
    leap_m_s: float = 3.0


@dataclass(frozen=True, slots=True, eq=False)
class FilterState:
    """The filter state: the pose published at t_ns, of a body carried by `carrier`.

    smooth: without the correction; trust (J,): confidence in each bone's direction, 0..1; since_ns: start of the body;
    turning_rad_s (J,3), moving_m_s (3,): predicted velocities; lag_s: see `PoseFilter.lag_s`; memory (1+J,5): of
    `moving_share`, for the root and each bone.
    """

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
class PoseCorrection:
    """Difference of the published pose from the estimate: root_m (3,), rotvec_rad (J,3) of the global rotations. share:
    remaining part; speed_m_s: of the joints while it shrinks."""

    root_m: Floats
    rotvec_rad: Floats
    speed_m_s: float
    share: float = 1.0

    def of(self, pose: Pose, share: float) -> Pose:
        """The estimate plus this share of the correction."""
        turned = rotations.multiply(rotations.exp(share * self.rotvec_rad), pose.quats_xyzw)
        return Pose(pose.root_m + share * self.root_m, rotations.canonical(turned))


class PoseFilter:
    """Keeps the last published pose and the remaining correction."""

    def __init__(self, params: PoseFilterParams | None = None) -> None:
        self._params = params if params is not None else PoseFilterParams()
        self.reset()

    def rehearse(self, skeleton: Skeleton) -> None:
        """Filters a rest pose once, so that the first person need not wait for the kernel to compile or load."""
        rest = Pose(np.zeros(3), np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1)))
        for frame in range(2):
            self.step(rest, np.ones(N_JOINTS), frame, Carrier("shirt", True, 1), skeleton)
        self.reset()

    def reset(self) -> None:
        """Forgets the body."""
        self._last: FilterState | None = None
        self._before: Pose | None = None  # published before that
        self._correction: PoseCorrection | None = None
        self._changed_ns: int | None = None  # last change of the carrying cues
        self._way_m: Floats | None = None  # last step of each joint (J,3), for `_leaps`

    @property
    def lag_s(self) -> float:
        """Lag of steady motion in the last step [s]: mean over the bones, weighted by trust. 0 while poses are published
        unfiltered."""
        return 0.0 if self._last is None else self._last.lag_s

    def step(
        self,
        found: Pose,
        confidence: Floats,
        t_ns: int,
        by: Carrier,
        skeleton: Skeleton,
        jumped: Collection[int] = (),
        legs_since_ns: int | None = None,
    ) -> Pose:
        """The pose to publish for a measured pose with joint confidence (J,).

        by: what carries the body; jumped: bones that were relocated and did not move there; legs_since_ns: first fit of legs
        and head.
        """
        p, last = self._params, self._last
        if last is None or seconds(t_ns - last.t_ns) >= _RESET_AFTER_S:
            self.reset()
            trust = confidence[END_OF_BONE]
            self._last = FilterState(t_ns, by.cues, found, found, trust, t_ns)
            return found
        expected = self._extrapolate(last)
        if last.carrier != by.cues:
            self._changed_ns, self._way_m = t_ns, None
        now = self._filter_pose(found, confidence, t_ns, by, last, jumped, legs_since_ns)
        leaps = self._changed_ns is not None and self._leaps(now, last, skeleton)
        arms_jumped = by.shirt and not set(jumped) <= LOWER
        if last.carrier != by.cues or arms_jumped or leaps:
            self._correction = _correction_between(expected, now.smooth, skeleton, p)
        if self._correction is not None:
            step_m = min(
                p.step_m, max(self._correction.speed_m_s * seconds(t_ns - last.t_ns), _LEAST_STEP_M)
            )
            self._correction = _shrink_correction(now.smooth, self._correction, skeleton, step_m)
        if self._correction is not None:
            now = replace(now, pose=self._correction.of(now.smooth, self._correction.share))
        elif self._changed_ns is not None and t_ns - self._changed_ns > nanoseconds(p.approach_s):
            self._changed_ns = None
        self._before, self._last = last.pose, now
        return now.pose

    def _extrapolate(self, last: FilterState) -> Pose:
        """The last published pose, extrapolated by its last motion."""
        if self._before is None:
            return last.pose
        turn = rotations.multiply(last.pose.quats_xyzw, rotations.inverse(self._before.quats_xyzw))
        quats = rotations.canonical(rotations.multiply(turn, last.pose.quats_xyzw))
        return Pose(2.0 * last.pose.root_m - self._before.root_m, quats)

    def _leaps(self, now: FilterState, last: FilterState, skeleton: Skeleton) -> bool:
        """True if a joint's step differs from its previous step by more than human motion allows."""
        p, gap_s = self._params, seconds(now.t_ns - last.t_ns)
        if now.carrier != last.carrier:
            return False
        way_m = joint_positions(skeleton, now.smooth) - joint_positions(skeleton, last.smooth)
        before_m, self._way_m = self._way_m, way_m
        if before_m is None:
            return False
        most_m = max(p.step_m, p.leap_m_s * gap_s)
        return bool(np.linalg.norm(way_m - before_m, axis=1).max() > most_m)

    def _filter_pose(
        self,
        found: Pose,
        confidence: Floats,
        t_ns: int,
        by: Carrier,
        last: FilterState,
        jumped: Collection[int],
        legs_since_ns: int | None,
    ) -> FilterState:
        p, trust = self._params, confidence[END_OF_BONE]
        gains, trust_s = gains_of(by)
        if by.shirt:
            trust[SHIRT_TRUNK_BONES] = 1.0
        elif t_ns - last.since_ns < nanoseconds(p.settles_s):
            return FilterState(t_ns, by.cues, found, found, trust, last.since_ns)
        if last.carrier != by.cues:  # the offset begins at what the new cues found
            return FilterState(
                t_ns,
                by.cues,
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
            found.quats_xyzw, last.smooth.quats_xyzw, trust, gains, gap_s, ticks, p.learns, memory[1:], turning,
            quats, follows, learned,
        )  # fmt: skip
        moving = gains[6, 0] ** ticks * last.moving_m_s
        expected_m = last.smooth.root_m + gap_s * moving
        way_m = found.root_m - expected_m
        speed_m_s = float(np.linalg.norm(last.moving_m_s))
        share = follows[0] * moving_share(way_m, speed_m_s, memory[0], ticks, root_noise_m(by))
        root_m = expected_m + share * way_m
        moving += learned[0] * ((root_m - last.smooth.root_m) / gap_s - moving)
        if legs_since_ns is not None and t_ns - legs_since_ns < nanoseconds(p.settles_s):
            quats[LOWER_BONES], turning[LOWER_BONES] = found.quats_xyzw[LOWER_BONES], 0.0
        pose = Pose(root_m, quats)
        lag_s = _lag_s(gap_s, follows, learned, gains[6] ** ticks, trust)
        return FilterState(
            t_ns, by.cues, pose, pose, trust, last.since_ns, turning, moving, lag_s, memory
        )


def _lag_s(gap_s: float, follows: Floats, learned: Floats, keep: Floats, trust: Floats) -> float:
    """See the module; follows, learned, retained (J,): f, l and g of each bone."""
    lags_s = gap_s * (1.0 / follows - 1.0) * (1.0 - keep) / (1.0 - keep + keep * learned)
    weights = trust + 1e-6
    return float(lags_s @ weights / weights.sum())


def _correction_between(
    published: Pose, target: Pose, skeleton: Skeleton, params: PoseFilterParams
) -> PoseCorrection:
    turn = rotations.multiply(published.quats_xyzw, rotations.inverse(target.quats_xyzw))
    way_m = joint_positions(skeleton, published) - joint_positions(skeleton, target)
    farthest_m = float(np.linalg.norm(way_m, axis=1).max())
    speed_m_s = max(farthest_m / params.approach_s, params.approach_m_s)
    return PoseCorrection(published.root_m - target.root_m, rotations.log(turn), speed_m_s)


def _shrink_correction(
    target: Pose, offset: PoseCorrection, skeleton: Skeleton, step_m: float
) -> PoseCorrection | None:
    """The correction, reduced so far that no joint moves by more than step_m beyond its own motion; None once it is zero."""
    before_m = joint_positions(skeleton, offset.of(target, offset.share))

    def is_near(share: float) -> bool:
        joints_m = joint_positions(skeleton, offset.of(target, share))
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
