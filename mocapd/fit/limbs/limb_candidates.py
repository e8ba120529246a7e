"""Pose hypotheses of a limb: mirror images in depth, low-discrepancy samples, and the best distinct ones.

A tracked limb can slip into a pose that looks right to one camera. Candidates are its mirror images
in depth along each camera's view (the two poses of a segment that project alike, Sminchisescu and
Triggs 2003), and a low-discrepancy cloud about the present pose and about rest.
"""

from collections.abc import Sequence
from functools import cache

import numpy as np

from mocapd.body.skeleton import PARENTS
from mocapd.fit.limbs.arm_samples import Arm
from mocapd.fit.limbs.limb_search_kernels import mirrored_in_depth
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.view import View
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import centre
from mocapd.types import Floats

_ALIKE = 0.985  # cosine of half the angle between two poses of a bone, 20 degrees


def candidates(
    fitter: Fitter,
    state: MotionState,
    limb: Arm,
    views: Sequence[View],
    cloud: Floats,
    library: Floats,
    first: int = 1,
) -> Floats:
    """Local rotations (N,3,4) of a limb's first three bones to try; the first is the present pose.

    cloud (C,6): rotation vectors to turn its two long bones by; library (L,3,4): poses to try as they are; first: which of
    the three is the first long one, that of an arm after its collar.
    """
    joints, globals_ = fitter.joints(state)
    upper, lower, end = limb.chain[first : first + 3]
    present = state.local_xyzw[limb.chain[:3]]
    out = [present[None]]
    for view in views:
        mirrored = np.repeat(present[None], 3, axis=0)
        mirrored_in_depth(
            joints[[upper, lower, end]], globals_[[upper, lower]], globals_[PARENTS[upper]],
            centre(fitter.drawings[view.index].camera), mirrored[:, first : first + 2],
        )  # fmt: skip
        out.append(mirrored)
    turned = np.repeat(present[None], len(cloud), axis=0)
    turned[:, first : first + 2] = turned_about(present[first : first + 2], cloud)
    return np.concatenate([*out, turned, library])


def turned_about(bones_xyzw: Floats, cloud: Floats) -> Floats:
    """Poses (C,2,4) of a limb's two long bones (2,4), turned by the rotation vectors of a cloud (C,6)."""
    turned = np.repeat(bones_xyzw[None], len(cloud), axis=0)
    turned[:, 0] = rotations.multiply(rotations.exp(cloud[:, :3]), turned[:, 0])
    turned[:, 1] = rotations.multiply(rotations.exp(cloud[:, 3:]), turned[:, 1])
    return turned


@cache
def spread(size: int) -> Floats:
    """The first `size` points (size,6) of the Halton sequence, without the origin (Halton 1960). Shared: not to be
    changed."""
    out = np.zeros((size, 6))
    for column, base in enumerate((2, 3, 5, 7, 11, 13)):
        n, f = np.arange(1, size + 1), 1.0
        while n.any():
            f /= base
            out[:, column] += f * (n % base)
            n //= base
    return out


def part(rows: Floats, turn: int, size: int) -> Floats:
    """As many of the rows (N,...), others each turn."""
    first = (turn * size) % len(rows)
    return rows[first : first + size]


def best_poses(bones_xyzw: Floats, scores: Floats, keep: int) -> list[int]:
    """Places of the `keep` best poses of a limb's two long bones (N,2,4), best first, no two alike; none below the first, the
    present pose."""
    out: list[int] = []
    for n in np.argsort(-scores, kind="stable").tolist():
        if n == 0 or len(out) == keep:
            break
        # close hypotheses converge to the same optimum
        if not any(_is_alike(bones_xyzw[n], bones_xyzw[other]) for other in out):
            out.append(n)
    return out


def _is_alike(a_xyzw: Floats, b_xyzw: Floats) -> bool:
    return bool(np.abs((a_xyzw * b_xyzw).sum(axis=1)).min() > _ALIKE)


def turned_rad2(bones_xyzw: Floats, from_xyzw: Floats) -> Floats:
    """By how much a limb's two long bones differ: squared angles (N,), of poses (N,2,4) from one (2,4) [rad^2]."""
    cosines = np.abs((bones_xyzw * from_xyzw).sum(axis=2))
    turned: Floats = ((2.0 * np.arccos(np.minimum(cosines, 1.0))) ** 2).sum(axis=1)
    return turned
