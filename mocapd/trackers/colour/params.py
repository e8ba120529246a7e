"""Every number of the colour tracker, with its unit and its reason."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Params:
    """Parameters of the full tracker; lengths in work pixels are after downsampling to `work_width_px`."""

    # picture
    work_width_px: int = 320  # frames are averaged down by a whole factor to about this width
    margin_px: int = 28  # work px looked at around the predicted body

    # classification, paper section 5.2
    threshold: float = 5.0  # T of the pose-assisted classifier [standard deviations]
    prior_weight: float = 6.0  # C = prior_weight / size of the predicted shirt [work px]
    background_penalty: float = 2.5  # [standard deviations] added where the static background is seen
    other_penalty: float = 2.5  # the same where the colour is rather seen on other things
    background_tolerance: float = 0.055  # largest channel difference to the background, 0..1
    poor_classification: float = 0.4  # under this share of shirt pixels, other illuminations are tried
    new_illumination: float = 0.5  # Frobenius distance at which a W joins the cache
    colour_memory_s: float = 0.7  # time constant of the learned colours
    colour_sd_floor: float = 0.022  # sensor noise and cloth [0..1]
    shading_sd: float = 0.10  # spread of brightness over the cloth, as a share of the colour

    # alignment
    iterations: int = 5
    first_radius_px: int = 20  # search radius of the first and the last iteration [work px]
    last_radius_px: int = 7
    row_weight: float = 0.06  # inverse variance of a pixel's residual, neighbours being correlated
    soft_unclassified: float = 0.25  # weight of a rendered pixel over foreground of no known colour
    soft_unknown: float = 0.5  # the same where the background was never seen

    # motion: spread of the prediction after one frame, growing with the square root of time
    prediction_damping: float = 0.8
    root_sd_m: float = 0.10
    hips_sd_rad: float = 0.3
    spine_sd_rad: float = 0.2
    collar_sd_rad: float = 0.2
    arm_sd_rad: float = 0.8
    forearm_sd_rad: float = 0.8

    limit_sd_rad: float = 0.08  # softness of the joint limits

    # body shape
    shape_gain: float = 0.3  # share of a frame's information kept: neighbours in time are correlated
    shape_learning_s: float = 6.0  # proportions settle over the first seconds

    # decisions
    live_match: float = 0.45  # share of rendered shirt pixels whose colour the picture has: tracked
    accept_match: float = 0.62  # the same, to accept a new pose
    accept_colours: int = 6  # colours that must be seen matched to accept a new pose
    min_shirt_px: int = 150  # work px of matched shirt, all cameras together
    coast_s: float = 0.25
