"""The velocity of a body between two fits."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from mocapd.body.model import BodyModel
from mocapd.fit.fit_params import TICK_S
from mocapd.fit.motion_state import MotionState, step_between
from mocapd.types import Floats

_UNSEEN = 0.15  # confirmed share of an arm up to which its measured velocity gets no weight


@dataclass(frozen=True, slots=True)
class VelocityParams:
    """Human speed limits, and the visibility that an arm's velocity needs."""

    fastest_rad_s: float = 15.0
    fastest_m_s: float = 4.0
    arm_trust: float = 0.3  # above that, range of the share over which the weight rises to 1
    hidden_arm_keeps: float = 0.7  # share of its velocity that an unconfirmed arm keeps for a tick


def velocity_between(
    model: BodyModel,
    last: MotionState,
    state: MotionState,
    confirmed_arms: Mapping[str, float],
    dt_s: float,
    jumped: Iterable[slice],
    params: VelocityParams,
) -> Floats:
    """Velocity (n_pose,) of the pose parameters per second, from the last state dt_s [s] ago to this one; 0 for parameters
    that jumped. confirmed_arms: shares 0..1 by side, see `Fit`."""
    p = params
    before, now = (last.root_m, last.local_xyzw), (state.root_m, state.local_xyzw)
    velocity = step_between(model, now, before) / dt_s
    velocity[:3] = velocity[:3].clip(-p.fastest_m_s, p.fastest_m_s)
    velocity[3:] = velocity[3:].clip(-p.fastest_rad_s, p.fastest_rad_s)
    for side, share in confirmed_arms.items():
        # blend measured velocity and decayed old velocity by the arm's visibility
        trust = min(max((share - _UNSEEN) / p.arm_trust, 0.0), 1.0)
        columns = model.space.columns(f"{side}_arm")
        decayed = p.hidden_arm_keeps ** (dt_s / TICK_S) * last.velocity[columns]
        velocity[columns] = trust * velocity[columns] + (1.0 - trust) * decayed
    for columns in jumped:
        velocity[columns] = 0.0
    return velocity
