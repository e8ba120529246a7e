"""The prior of a fit around the predicted pose: covariance of the last fit plus process noise, weaker for unconfirmed
arms."""

from collections.abc import Mapping

from mocapd.fit.fit_params import TICK_S, MotionPriorParams
from mocapd.fit.fit_result import Fit
from mocapd.fit.priors.motion_prior import predicted_information
from mocapd.fit.solver import Fitter
from mocapd.types import Floats


def prediction_prior(
    fitter: Fitter,
    last: Fit,
    velocity: Floats,
    dt_s: float,
    confirmed_arms: Mapping[str, float],
    sure_arm: float,
    params: MotionPriorParams,
) -> Floats:
    """Information (n_pose,n_pose) of a pose predicted dt_s after the last fit, with velocity (n_pose,) per second.

    confirmed_arms: shares 0..1 by side, see `Fit`; sure_arm: that from which an arm's prior has full weight.
    """
    columns = fitter.model.space.columns
    arms = [
        (columns(f"{side}_arm"), min(share / sure_arm, 1.0))
        for side, share in confirmed_arms.items()
    ]
    return predicted_information(
        last.covariance, velocity * dt_s, dt_s / TICK_S, fitter.prediction_sd, arms, params
    )
