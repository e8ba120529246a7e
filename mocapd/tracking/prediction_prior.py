"""The prior of a fit around the predicted pose: covariance of the last fit plus process noise, weaker for unconfirmed
arms."""

from mocapd.body.pose_space import SIDES
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
    uncertain_arm: float,
    params: MotionPriorParams,
) -> Floats:
    """Information (n_pose,n_pose) of a pose predicted dt_s after the last fit, with velocity (n_pose,) per second.

    uncertain_arm: confirmed share of an arm's pixels from which its prior has full weight.
    """
    confirmed, columns = last.confirmed_arms, fitter.model.space.columns
    arms = [(columns(f"{side}_arm"), min(confirmed[side] / uncertain_arm, 1.0)) for side in SIDES]
    return predicted_information(
        last.covariance, velocity * dt_s, dt_s / TICK_S, fitter.prediction_sd, arms, params
    )
