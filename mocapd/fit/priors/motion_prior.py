"""Motion prior of the pose: the last fit's covariance plus process noise.

The prediction step of a Kalman filter over the pose parameters. A direction that the pictures determine well is held to its
prediction as tightly as the wearer moves calmly; one that they hardly determine (depth before one camera) stays open, and so
is averaged over many frames rather than locked.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from mocapd.fit.fit_params import TICK_S
from mocapd.fit.fit_result import Fit
from mocapd.fit.positive_inverse import positive_inverse
from mocapd.fit.solver import Fitter
from mocapd.types import Floats

# motion of a wearer between nominal frames: a constant, and a multiple of the last step
_CALM_M = 0.003
_CALM_RAD = 0.01
_CALM_GAIN = 2.0
_HIDDEN_SD_RAD = 0.06  # of an unconfirmed arm


def predicted_information(
    covariance: Floats,
    last_step: Floats,
    frames: float,
    usual_sd: Floats,
    limbs: Sequence[tuple[slice, float]],
) -> Floats:
    """Information (P,P) of the prediction, from the covariance (P,P) of the last fit.

    last_step (P,): by how much the pose moved in the last frame; frames: how many usual frames ago that was;
    usual_sd (P,): what holds any pose at least; limbs: the parameters of each, and how well it was confirmed, 0..1.
    """
    length = np.linalg.norm(last_step.reshape(-1, 3), axis=1)
    sd = _CALM_GAIN * length
    sd[0] += _CALM_M
    sd[1:] += _CALM_RAD
    moved_sd = np.minimum(np.repeat(sd, 3), usual_sd)
    for columns, confirmed in limbs:
        if confirmed < 1.0:
            moved_sd[columns] = _HIDDEN_SD_RAD + confirmed * (moved_sd[columns] - _HIDDEN_SD_RAD)
    spread = covariance.copy()
    spread[np.diag_indices(len(spread))] += moved_sd**2 * max(frames, 0.5)
    information = positive_inverse(spread)
    information[np.diag_indices(len(spread))] += 1.0 / (usual_sd**2 * max(frames, 0.5))
    return information


def prediction_prior(
    fitter: Fitter,
    last: Fit,
    velocity: Floats,
    dt_s: float,
    confirmed_arms: Mapping[str, float],
    sure_arm: float,
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
        last.covariance, velocity * dt_s, dt_s / TICK_S, fitter.prediction_sd, arms
    )
