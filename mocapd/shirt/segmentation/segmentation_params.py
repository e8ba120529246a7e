"""Parameters of the segmentation: colours, background, light; with units and reasons."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class SegmentationParams:
    """Parameters of a camera's segmentation; work pixels are those of frames averaged down."""

    margin_px: int = 22  # looked at around the predicted body [work px]
    uncertain_margin_px: int = 50  # the same while an arm is uncertain

    # classification, paper section 5.2; thresholds are lower than the paper's 3 and 5 because the
    # spread admits shade and noise
    threshold: float = 3.0  # T of the pose-assisted classifier [standard deviations]
    prior_weight: float = 6.0  # C = prior_weight / size of the predicted shirt [work px]
    first_threshold: float = 1.7  # T without a pose, whole picture
    cloth_sd: float = 0.04  # spread of the cloth's own colour, in white-balanced light [0..1]
    noise_sd: float = 0.015  # sensor noise and compression [0..1]
    shading_sd: float = 0.25  # spread of brightness over the cloth, as a share of the colour
    # by how much nearer a colour must be for a pixel like its background to be either [standard deviations]
    background_penalty: float = 1.5
    other_penalty: float = 1.5  # added to colours that are more frequent on other objects
    skin_penalty: float = 0.3  # by how much skin must be nearer than a colour of the shirt
    bare_threshold: float = 3.0  # from which on nothing is skin [standard deviations]
    skin_memory_s: float = 1.0  # time constant of the colour of the skin
    background_tolerance: float = 0.055  # largest channel difference to the background, 0..1
    soft_unclassified: float = 0.25  # weight of a rendered pixel over foreground of another colour
    soft_unknown: float = 0.5  # the same over unknown background

    # the light
    poor_classification: float = 0.4  # under this share of shirt pixels, other lights are tried
    sudden_loss: float = 0.93  # or under this share of what was usual in the last seconds
    usual_s: float = 2.0  # time constant of what is usual
    colour_memory_s: float = 0.4  # time constant of the learned colours
    count_memory_s: float = 2.5  # time constant of the colour counts, shirt against others
    sure_match: float = 0.6  # agreement of a pose, to learn from it what is shirt and what is not

    found_evenness: float = 0.12  # of a window of ids (find_shirt), to ask the database at all
