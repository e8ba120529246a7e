"""The velocity of a body between two fits."""

from collections.abc import Iterable, Mapping

from mocapd.body.model import BodyModel
from mocapd.fit.fit_params import TICK_S
from mocapd.fit.motion_state import MotionState, step_between
from mocapd.types import Floats

_UNSEEN = 0.15  # confirmed share of an arm up to which its measured velocity gets no weight
_ARM_TRUST = 0.3  # above that, range of the share over which the weight rises to 1
_HIDDEN_ARM_KEEPS = 0.7  # share of its velocity that an unconfirmed arm keeps for a tick
# human speed limits
_FASTEST_RAD_S = 15.0
_FASTEST_M_S = 4.0


def velocity_between(
    model: BodyModel,
    last: MotionState,
    state: MotionState,
    confirmed_arms: Mapping[str, float],
    dt_s: float,
    jumped: Iterable[slice],
) -> Floats:
    """Velocity (n_pose,) of the pose parameters per second, from the last state dt_s [s] ago to this one; 0 for parameters
    that jumped. confirmed_arms: shares 0..1 by side, see `Fit`."""
    before, now = (last.root_m, last.local_xyzw), (state.root_m, state.local_xyzw)
    velocity = step_between(model, now, before) / dt_s
    velocity[:3] = velocity[:3].clip(-_FASTEST_M_S, _FASTEST_M_S)
    velocity[3:] = velocity[3:].clip(-_FASTEST_RAD_S, _FASTEST_RAD_S)
    for side, share in confirmed_arms.items():
        # blend measured velocity and decayed old velocity by the arm's visibility
        trust = min(max((share - _UNSEEN) / _ARM_TRUST, 0.0), 1.0)
        columns = model.space.columns(f"{side}_arm")
        decayed = _HIDDEN_ARM_KEEPS ** (dt_s / TICK_S) * last.velocity[columns]
        velocity[columns] = trust * velocity[columns] + (1.0 - trust) * decayed
    for columns in jumped:
        velocity[columns] = 0.0
    return velocity
