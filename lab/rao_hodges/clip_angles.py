"""Angles of the limbs of Rao and Hodges from clips of real motion: the ground truth of their experiment."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lab.simulated.motion_clip import MotionClip
from mocapd.published.rao_hodges.limb_angles import arm_angles, legs_angles
from mocapd.types import Floats

LIMBS = ("legs", "left_arm", "right_arm")


@dataclass(frozen=True, slots=True, eq=False)
class LimbAngles:
    """angles (F,D) [rad] of one limb chain, continuous over frames that are dt_s apart."""

    clip: str
    limb: str
    dt_s: float
    angles: Floats


def limb_angles(clip: MotionClip, limb: str, every: int = 1) -> LimbAngles:
    """Of one of LIMBS, in the order of its chain's angles; every: how many of the clip's frames are one step."""
    quats = clip.global_xyzw[::every]
    found = legs_angles(quats) if limb == "legs" else arm_angles(quats, limb.removesuffix("_arm"))
    for first in (0, 5) if limb == "legs" else (0,):
        _make_continuous(found[:, first : first + 3])
    return LimbAngles(clip.name, limb, every / clip.rate_hz, np.unwrap(found, axis=0))


def other_angles(ball: Floats) -> Floats:
    """The other three angles (...,3) of the same rotation, beyond 90 degrees of the middle one."""
    return np.array([np.pi, np.pi, np.pi]) + np.array([1.0, -1.0, 1.0]) * ball


def wrapped(angles: Floats) -> Floats:
    """The same angles within half a turn of 0."""
    within: Floats = (angles + np.pi) % (2.0 * np.pi) - np.pi
    return within


def angle_errors(limb: str, found: Floats, true: Floats) -> Floats:
    """(D,) [rad]: absolute differences, a ball joint against that of the two triples of its true angles which is nearer."""
    off: Floats = np.abs(wrapped(found - true))
    for first in (0, 5) if limb == "legs" else (0,):
        ball = np.s_[first : first + 3]
        other = np.abs(wrapped(found[ball] - other_angles(true[ball])))
        if other.sum() < off[ball].sum():
            off[ball] = other
    return off


def _make_continuous(ball: Floats) -> None:
    """Replace triples (F,3) by the other one of the same rotation where that is nearer to the frame before."""
    for now, last in zip(ball[1:], ball[:-1], strict=True):
        other = other_angles(now)
        if np.abs(wrapped(other - last)).sum() < np.abs(wrapped(now - last)).sum():
            now[:] = wrapped(other)


def steps_and_ranges(
    clips: Sequence[MotionClip], kinds_of: dict[str, tuple[tuple[str, ...], tuple[bool, ...]]]
) -> tuple[dict[str, Floats], dict[str, Floats]]:
    """By kind of angle all steps and all values [rad], those of the right side mirrored; kinds_of: kinds and mirrored of
    each limb's chain."""
    steps: dict[str, list[Floats]] = {}
    values: dict[str, list[Floats]] = {}
    for limb, (kinds, mirrored) in kinds_of.items():
        for clip in clips:
            angles = limb_angles(clip, limb).angles
            for d, (kind, other) in enumerate(zip(kinds, mirrored, strict=True)):
                value = wrapped(angles[:, d])
                steps.setdefault(kind, []).append(np.abs(np.diff(angles[:, d])))
                values.setdefault(kind, []).append(-value if other else value)
    return (
        {kind: np.concatenate(some) for kind, some in steps.items()},
        {kind: np.concatenate(some) for kind, some in values.items()},
    )
