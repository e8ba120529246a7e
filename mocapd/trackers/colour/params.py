"""Every number of the colour tracker, with its unit and its reason."""

from dataclasses import dataclass

TICK_S = 1.0 / 30.0  # a usual frame: what is said per frame is meant for one of this length


@dataclass(frozen=True, slots=True)
class Params:
    """Parameters of the full tracker; work pixels are those of frames averaged down to `work_width_px`."""

    work_width_px: int = 320
    margin_px: int = 22  # looked at around the predicted body [work px]
    doubt_margin_px: int = 50  # the same while an arm is in doubt

    # classification, paper section 5.2; thresholds are lower than the paper's 3 and 5 because the
    # spread admits shade and noise: see docs/decisions/classification.md
    threshold: float = 3.0  # T of the pose-assisted classifier [standard deviations]
    prior_weight: float = 6.0  # C = prior_weight / size of the predicted shirt [work px]
    first_threshold: float = 1.7  # T without a pose, whole picture
    cloth_sd: float = 0.04  # spread of the cloth's own colour, in white-balanced light [0..1]
    noise_sd: float = 0.015  # sensor noise and compression [0..1]
    shading_sd: float = 0.25  # spread of brightness over the cloth, as a share of the colour
    background_penalty: float = 1.5  # added where static background is seen [standard deviations]
    other_penalty: float = 1.5  # added where the colour is rather seen on other things
    background_tolerance: float = 0.055  # largest channel difference to the background, 0..1
    background_jump: float = 0.25  # share of the background that changes at once when a lamp does
    poor_classification: float = 0.4  # under this share of shirt pixels, other lights are tried
    sudden_loss: float = 0.93  # or under this share of what was usual in the last seconds
    usual_s: float = 2.0  # time constant of what is usual
    colour_memory_s: float = 0.4  # time constant of the learned colours
    count_memory_s: float = 2.5  # time constant of the colour counts, shirt against others

    # alignment
    iterations: int = 4
    first_radius_px: int = 20  # search radius of the first and the last iteration [work px]
    last_radius_px: int = 7
    fine_iterations: int = (
        2  # the last ones, at all work pixels; the others at every second each way
    )
    edge_stiffness: float = 1.0  # weight of an edge in place against a pixel that disagrees, fine
    row_weight: float = 0.06  # inverse variance of a pixel's residual; neighbours are correlated
    soft_unclassified: float = 0.25  # weight of a rendered pixel over foreground of no known colour
    soft_unknown: float = 0.5  # the same where the background was never seen

    # motion: spread of the prediction over 1/30 s, growing with the square root of time
    prediction_damping: float = 0.6
    velocity_memory: float = 0.0  # share of the last velocity kept
    arm_trust: float = 0.3  # range of confirmation over which an arm's velocity is believed
    root_sd_m: float = 0.10
    hips_sd_rad: float = 0.3
    spine_sd_rad: float = 0.2
    collar_sd_rad: float = 0.2
    arm_sd_rad: float = 0.2
    # at rest, of the left side [rotation vectors, rad]: means over recorded everyday motion (CMU,
    # HDM05), with about twice its spread so that a raised arm is hardly held back
    upper_arm_rest_rad: tuple[float, float, float] = (0.13, -0.33, -1.2)
    upper_arm_sd_rad: float = 1.2
    elbow_rest_rad: tuple[float, float, float] = (0.0, -0.77, 0.0)
    elbow_sd_rad: tuple[float, float, float] = (0.5, 1.0, 1.0)
    limit_sd_rad: float = 0.08  # softness of the joint limits
    fastest_rad_s: float = 15.0
    fastest_m_s: float = 4.0

    # arms in doubt
    doubtful_arm: float = 0.45  # share of an arm's pixels confirmed, below which others are tried
    arm_cloud: int = 64  # tries about the present pose
    arm_library: int = 128  # tries over the whole range, another part each frame
    arm_fits: int = 1  # of which so many are fitted
    arm_gain: float = 10.0  # by how much the cost must fall to change over [disagreeing pixels]

    # body shape
    learn_shape: bool = True
    shape_gain: float = 0.02  # share of a frame's information kept: errors last over frames
    shape_learning_s: float = 6.0  # proportions settle over the first seconds of good tracking
    shape_match: float = 0.7  # least agreement of a frame that teaches

    # decisions
    live_match: float = 0.45  # share of rendered shirt pixels whose colour the picture has
    sure_match: float = 0.6  # the same, to learn from a frame what is shirt and what is not
    accept_match: float = 0.58  # the same, to accept a new pose
    accept_colours: int = 5  # colours that must be confirmed to accept a new pose
    min_shirt_px: int = 120  # confirmed work px, all cameras together
    found_evenness: float = 0.12  # of a window of ids (find_shirt), to ask the database at all
    doubt_match: float = 0.6  # under this agreement the shirt is looked for anew beside tracking
    doubt_pause_s: float = 0.4  # between such looks
    doubt_gain: float = 0.05  # by how much the agreement must be better to change over
    search_pause_s: float = 0.1  # between attempts that failed
    neighbours: int = 6  # of the pose database, per camera
