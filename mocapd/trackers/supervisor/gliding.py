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


class Glider:
    """What is told from frame to frame, without a jump where another speaks than before."""

    def __init__(self, params: Params) -> None:
        self._params = params
        self.reset()

    def reset(self, told: BodyState | None = None) -> None:
        """As if this had been told a moment ago."""
        self._told = told if told is not None and told.pose is not None else None
        self._away: Away | None = None
        self._speed_m_s = 0.0

    def begins(self, body: BodyState) -> bool:
        """Whether another spoke in the frame before, a moment ago."""
        return (
            self._told is not None
            and self._told.tracker != body.tracker
            and body.t_ns - self._told.t_ns <= nanoseconds(self._params.glide_within_s)
        )

    def step(
        self, body: BodyState, before: BodyState | None, skeleton: Skeleton
    ) -> tuple[BodyState, bool]:
        """A body (with a pose) as it is to be told, and whether it is on its way. before: where another speaks now, what
        that would have told in the frame before, None when nobody knows."""
        p, told = self._params, self._told
        assert body.pose is not None
        gap_ns = 0 if told is None else body.t_ns - told.t_ns
        if told is None or told.pose is None or gap_ns > nanoseconds(p.glide_within_s):
            self._away = None
        elif told.tracker != body.tracker:
            # the motion since then is not to be mended
            known = before.pose if before is not None and before.pose is not None else body.pose
            self._away = away_from(told.pose, known)
            way_m = _farthest_m(told.pose, known, skeleton)
            self._speed_m_s = max(way_m / p.glide_s, p.glide_m_s)
        if self._away is not None:
            step_m = min(p.glide_m, max(self._speed_m_s * seconds(gap_ns), _LEAST_M))
            self._away = lessened(body.pose, self._away, skeleton, step_m)
        if self._away is not None:
            body = glided(body, self._away, skeleton)
        self._told = body
        return body, self._away is not None


def glided(body: BodyState, away: Away, skeleton: Skeleton) -> BodyState:
    """The body as it is told, and how much less certain its joints are for that; it has a pose."""
    assert body.pose is not None
    pose = off(body.pose, away, away.share)
    joints_m = joint_positions(skeleton, pose)
    wrong_m = np.linalg.norm(joints_m - joint_positions(skeleton, body.pose), axis=1)
    # one standard deviation along an axis
    uncertainty_m = np.hypot(body.uncertainty_m, wrong_m / np.sqrt(3.0))
    return replace(body, pose=pose, joints_m=joints_m, uncertainty_m=uncertainty_m)


def _farthest_m(one: Pose, other: Pose, skeleton: Skeleton) -> float:
    apart_m = joint_positions(skeleton, one) - joint_positions(skeleton, other)
    return float(np.linalg.norm(apart_m, axis=1).max())
