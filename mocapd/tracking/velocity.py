"""How fast a body is taken to move, from one fit to the next."""

from collections.abc import Iterable
from dataclasses import dataclass

from mocapd.body.model import BodyModel
from mocapd.body.pose_space import SIDES
from mocapd.fit.fit_result import Fit
from mocapd.fit.motion_state import MotionState, step_between
from mocapd.types import Floats

_UNSEEN = 0.15  # confirmation of an arm up to which its velocity is not believed at all


@dataclass(frozen=True, slots=True)
class VelocityParams:
    """What people do, and how far an arm must be seen."""

    fastest_rad_s: float = 15.0
    fastest_m_s: float = 4.0
    arm_trust: float = 0.3  # range of confirmation over which an arm's velocity is believed
    hidden_arm_glide: float = (
        0.7  # share of its velocity that such an arm keeps from frame to frame
    )


def velocity_between(
    model: BodyModel,
    last: MotionState,
    fit: Fit,
    dt_s: float,
    jumped: Iterable[slice],
    params: VelocityParams,
) -> Floats:
    """Of the pose (n_pose,) per second, from the step since the last one, dt_s [s] ago; 0 of the parameters that jumped."""
    p, state = params, fit.state
    before, now = (last.root_m, last.local_xyzw), (state.root_m, state.local_xyzw)
    velocity = step_between(model, now, before) / dt_s
    velocity[:3] = velocity[:3].clip(-p.fastest_m_s, p.fastest_m_s)
    velocity[3:] = velocity[3:].clip(-p.fastest_rad_s, p.fastest_rad_s)
    for side in SIDES:
        # what is hardly seen is hardly known to move
        trust = min(max((fit.confirmed_arms[side] - _UNSEEN) / p.arm_trust, 0.0), 1.0)
        columns = model.space.columns(f"{side}_arm")
        glide = p.hidden_arm_glide * last.velocity[columns]
        velocity[columns] = trust * velocity[columns] + (1.0 - trust) * glide
    for columns in jumped:
        velocity[columns] = 0.0
    return velocity
