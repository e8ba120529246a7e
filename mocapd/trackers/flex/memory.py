"""What is carried from frame to frame of somebody who is tracked, and how fast they are taken to move."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from mocapd.body.model import BodyModel
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fit
from mocapd.trackers.flex.params import Params
from mocapd.trackers.flex.rescue.seen_pose import WHOLE
from mocapd.trackers.velocity import velocity_between
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
    columns = [slice(None) if part == WHOLE else model.space.columns(part) for part in changed]
    return velocity_between(model, last, fit, dt_s, columns, params.velocity)
