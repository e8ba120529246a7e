"""What is carried from frame to frame of somebody who is tracked, and how fast they are taken to move."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from mocapd.body.model import BodyModel
from mocapd.body.pose_space import SIDES
from mocapd.fit.motion_state import MotionState, step_between
from mocapd.fit.solver import Fit
from mocapd.trackers.flex.params import Params
from mocapd.trackers.flex.rescue.seen_pose import WHOLE
from mocapd.types import Floats


@dataclass(frozen=True, slots=True, eq=False)
class Followed:
    """Somebody as they were fitted at t_ns, and the names of the cameras that showed them."""

    t_ns: int
    state: MotionState
    fit: Fit
    cameras: tuple[str, ...]
    changed: tuple[str, ...] = ()  # parts of the body that were found elsewhere


@dataclass(frozen=True, slots=True, eq=False)
class Proportions:
    """The proportions as handed in, in the tracker's space."""

    factors: Floats
    information: Floats


def of_wearer(known: Followed, wearer: Proportions) -> Followed:
    """What is carried on, of a wearer as known to whoever steps the tracker."""
    return replace(
        known,
        state=replace(known.state, factors=wearer.factors, information=wearer.information),
    )


def is_believed(fit: Fit, params: Params) -> bool:
    """Whether enough of the body agrees with the pictures."""
    # every second pixel was counted
    enough = 2.0 * fit.matched.sum() >= params.least_body_px
    return fit.explained >= params.live_explained and bool(enough)


def velocity_of(
    model: BodyModel,
    params: Params,
    fit: Fit,
    last: MotionState,
    dt_s: float,
    changed: Sequence[str],
) -> Floats:
    """Of the pose (n_pose,) per second, from the step since the last one; not of parts that changed over."""
    p, state = params, fit.state
    before, now = (last.root_m, last.local_xyzw), (state.root_m, state.local_xyzw)
    velocity = step_between(model, now, before) / dt_s
    velocity[:3] = velocity[:3].clip(-p.fastest_m_s, p.fastest_m_s)
    velocity[3:] = velocity[3:].clip(-p.fastest_rad_s, p.fastest_rad_s)
    for side in SIDES:
        # what is hardly seen is hardly known to move
        trust = min(max((fit.confirmed_arms[side] - 0.15) / p.arm_trust, 0.0), 1.0)
        columns = model.space.columns(f"{side}_arm")
        glide = p.hidden_arm_glide * last.velocity[columns]
        velocity[columns] = trust * velocity[columns] + (1.0 - trust) * glide
    for part in changed:
        velocity[slice(None) if part == WHOLE else model.space.columns(part)] = 0.0
    return velocity
