"""What is told glides to what another tracker knows, no joint farther in a frame than it may.

`trackers/blending.py` mends what one tracker had wrong, in eight frames whatever it was. Here the bodies are two trackers',
any distance apart, and the promise is of the joints' places: how much of the difference goes in a frame is looked for.
"""

from dataclasses import dataclass, replace

import numpy as np

from mocapd.body.skeleton import joint_positions
from mocapd.clock import nanoseconds, seconds
from mocapd.geometry import rotations
from mocapd.trackers.supervisor.params import Params
from mocapd.types import BodyState, Floats, Pose, Skeleton

_LEAST_M = 0.01  # in a frame, however short
_HALVINGS = 10  # of what is left: the way of a metre is known to a millimetre


@dataclass(frozen=True, slots=True, eq=False)
class Away:
    """What was told, off what is known: root_m (3,), rotvec_rad (J,3) of the global rotations; `share` is left of it."""

    root_m: Floats
    rotvec_rad: Floats
    share: float = 1.0


def away_from(told: Pose, known: Pose) -> Away:
    """From what is known to what was told."""
    turn = rotations.multiply(told.quats_xyzw, rotations.inverse(known.quats_xyzw))
    return Away(told.root_m - known.root_m, rotations.log(turn))


def off(known: Pose, away: Away, share: float) -> Pose:
    """The pose that is a share of the way off what is known."""
    turned = rotations.multiply(rotations.exp(share * away.rotvec_rad), known.quats_xyzw)
    return Pose(known.root_m + share * away.root_m, rotations.canonical(turned))


def lessened(known: Pose, away: Away, skeleton: Skeleton, step_m: float) -> Away | None:
    """As much less as no joint needs more than step_m for, beside its own motion; None when nothing is left."""
    told = joint_positions(skeleton, off(known, away, away.share))

    def reached(share: float) -> bool:
        joints = joint_positions(skeleton, off(known, away, share))
        return bool((np.linalg.norm(joints - told, axis=1) <= step_m).all())

    if reached(0.0):
        return None
    too_little, enough = 0.0, away.share
    for _ in range(_HALVINGS):
        middle = 0.5 * (too_little + enough)
        if reached(middle):
            enough = middle
        else:
            too_little = middle
    return replace(away, share=enough)


@dataclass(frozen=True, slots=True, eq=False)
class Sourced:
    """A body with a pose, and whose it is: a change of that is what is glided over."""

    body: BodyState
    source: str


class Glider:
    """What is told from frame to frame, without a jump where another speaks than before."""

    def __init__(self, params: Params) -> None:
        self._params = params
        self.reset()

    def reset(self, told: BodyState | None = None) -> None:
        """As if this had been told a moment ago."""
        self._told = told if told is not None and told.pose is not None else None
        self._last: Sourced | None = None  # what was known then
        self._moved_m: Floats | None = None  # each joint (J,3), since the frame before that
        self._moved: tuple[Pose, Pose] | None = None  # its pose then, and before that
        self._jumped = False  # otherwise than it moved
        self._away: Away | None = None
        self._speed_m_s = 0.0

    def is_new(self, now: Sourced) -> bool:
        """Whether another spoke in the frame before, so that `before` is asked for."""
        return self._last is None or self._last.source != now.source

    def step(
        self, now: Sourced, before: Sourced | None, skeleton: Skeleton
    ) -> tuple[BodyState, bool]:
        """A body as it is to be told, and whether it is on its way. before: what those who speak now would have told in
        the frame before, None when nobody knows."""
        p, told, body = self._params, self._told, now.body
        gap_ns = 0 if told is None else body.t_ns - told.t_ns
        is_new = self.is_new(now)
        if is_new:
            is_same = before is not None and before.source == now.source
            last = before.body if is_same and before is not None else None
        else:
            assert self._last is not None
            last = self._last.body
        moved_m = None if last is None else _moved(last, body)
        moved, jumped = _poses(last, body), False
        if told is None or gap_ns > nanoseconds(p.glide_within_s):
            self._away = None
        elif is_new:
            # the motion since then is not to be mended
            self._begin(told, body if last is None else last, skeleton)
        elif self._away is not None and moved_m is not None and self._jumps(moved_m, gap_ns):
            # who has just begun to speak settles: what is told goes on as it went, and that is not to be mended
            assert told.pose is not None
            pose = told.pose
            if self._moved is not None:
                pose = off(pose, away_from(*self._moved), 1.0)
            self._begin(replace(told, pose=pose), body, skeleton)
            if not self._jumped:  # else it moves otherwise now
                moved_m, moved = self._moved_m, self._moved
            jumped = True
        if self._away is not None and body.pose is not None:
            step_m = min(p.glide_m, max(self._speed_m_s * seconds(gap_ns), _LEAST_M))
            self._away = lessened(body.pose, self._away, skeleton, step_m)
        if self._away is not None:
            body = glided(body, self._away, skeleton)
        self._told, self._last = body, now
        self._moved_m, self._moved, self._jumped = moved_m, moved, jumped
        return body, self._away is not None

    def _begin(self, told: BodyState, known: BodyState, skeleton: Skeleton) -> None:
        assert told.pose is not None
        assert known.pose is not None
        self._away = away_from(told.pose, known.pose)
        way_m = joint_positions(skeleton, told.pose) - joint_positions(skeleton, known.pose)
        farthest_m = float(np.linalg.norm(way_m, axis=1).max())
        self._speed_m_s = max(farthest_m / self._params.glide_s, self._params.glide_m_s)

    def _jumps(self, moved_m: Floats, gap_ns: int) -> bool:
        """Whether a joint went farther, or otherwise than a moment ago, than a person moves."""
        p = self._params
        if self._moved_m is None:
            most_m = max(p.glide_m, p.jump_m_s * seconds(gap_ns))
            return bool(np.linalg.norm(moved_m, axis=1).max() > most_m)
        return bool(np.linalg.norm(moved_m - self._moved_m, axis=1).max() > p.jump_m)


def _poses(before: BodyState | None, now: BodyState) -> tuple[Pose, Pose] | None:
    """That of now and the one before."""
    if before is None or before.pose is None or now.pose is None:
        return None
    return now.pose, before.pose


def _moved(before: BodyState, now: BodyState) -> Floats:
    assert before.joints_m is not None
    assert now.joints_m is not None
    return now.joints_m - before.joints_m


def glided(body: BodyState, away: Away, skeleton: Skeleton) -> BodyState:
    """The body as it is told, and how much less certain its joints are for that; it has a pose."""
    assert body.pose is not None
    pose = off(body.pose, away, away.share)
    joints_m = joint_positions(skeleton, pose)
    wrong_m = np.linalg.norm(joints_m - joint_positions(skeleton, body.pose), axis=1)
    # one standard deviation along an axis
    uncertainty_m = np.hypot(body.uncertainty_m, wrong_m / np.sqrt(3.0))
    return replace(body, pose=pose, joints_m=joints_m, uncertainty_m=uncertainty_m)
