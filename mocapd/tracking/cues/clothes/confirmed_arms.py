"""How much of each arm the pictures confirm, for the prior of the next fit and for velocities."""

from collections.abc import Sequence

from mocapd.fit.fit_result import Fit
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.view import View
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams


def confirmed_arms(
    fitter: Fitter, fit: Fit, state: MotionState, views: Sequence[View], params: ClothesParams
) -> tuple[dict[str, float], float]:
    """Confirmed shares 0..1 by side, and the share from which on an arm is sure.

    Views that cross show whether a hand is where it is drawn, so an arm counts no more than its forearm there.
    """
    if fitter.has_small_baseline(state, views):
        return fit.confirmed_arms, params.limbs.uncertain_arm_small_baseline
    return fit.confirmed_to_hands, params.sure_to_hand
