"""Refine limb hypotheses by a fit, and take the cheapest if its gain exceeds a threshold."""

from collections.abc import Callable, Iterable
from dataclasses import replace

from mocapd.fit.fit_result import Fit
from mocapd.fit.limbs.arm_samples import Arm
from mocapd.fit.motion_state import MotionState
from mocapd.types import Floats


def with_limb(state: MotionState, limb: Arm, pose_xyzw: Floats) -> MotionState:
    """The state with another pose (3,4) of a limb's first three bones."""
    local = state.local_xyzw.copy()
    local[limb.chain[:3]] = pose_xyzw
    return replace(state, local_xyzw=local)


def cheapest_fit(
    fit: Fit,
    starts: Iterable[MotionState],
    refit: Callable[[MotionState], Fit],
    cost: Callable[[Fit], float],
    least: float,
) -> Fit:
    """The cheapest of the fits that begin at `starts`, if it costs less than `least`; else this one."""
    best = fit
    for start in starts:
        other = refit(start)
        other_cost = cost(other)
        if other_cost < least:
            best, least = other, other_cost
    return best
