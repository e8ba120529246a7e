"""Numbers of the head's tracking, with units and reasons."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class HeadParams:
    """Parameters of search, filter and loss."""

    # the filter
    particles: int = 100  # [Hecht 2009, section IV.A]
    measured_share: float = 0.3  # of the particles, drawn where the measurements are
    # spread of a head's acceleration; the hardest in recorded motion is 10 to 20
    push_sd_m_s2: float = 8.0
    jitter_sd_m: float = 0.006  # over 1/30 s, growing with the square root of time
    colour_weight: float = 6.0  # logarithm of a likelihood, by the difference of two odds -1..1
    edge_weight: float = 0.5  # of a full outline, against colours that differ by one
    full_edge: float = 30.0  # difference of brightness of a clear edge, 0..255
    outlier: float = 0.02  # share of measurements that are of something else
    face_sd: float = 0.09  # of a face box's middle, share of its side
    face_depth_sd: float = 0.15  # of a distance by apparent size, share
    depth_reach_m: float = 0.35  # of the search for the distance about the predicted one

    # finding
    nearest_m: float = 0.5
    # a face there is 17 px wide for a webcam, less than the detector's window
    farthest_m: float = 5.5
    least_windows: int = 3  # of a face that is believed
    least_looks: int = 2  # detections
    outline_looks: int = 6  # with a head outline before the background and no detected face
    candidates: int = 3
    candidate_s: float = 0.6  # validity of a face after its last detection
    size_share: tuple[float, float] = (0.65, 1.5)  # a face's true width against a grown person's
    meeting_m: float = 0.08  # how near the rays of two views must pass to mean one face

    # losing
    coast_s: float = 0.6  # without a face, colours or distance that agree
    least_support: float = 0.5  # of colours and outline together, at the best place
    facing_s: float = 0.4  # validity of a detected face for the person's facing direction
    learn_support: float = 0.9  # least support for learning colours without a face
