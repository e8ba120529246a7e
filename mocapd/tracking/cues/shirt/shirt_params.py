"""Parameters of the shirt cue and its parts, with units and reasons."""

from dataclasses import dataclass, field

from mocapd.fit.fit_params import FitParams, LimbSearchParams
from mocapd.fit.terms.stereo_match_term import StereoMatchParams
from mocapd.shirt.segmentation.segmentation_params import SegmentationParams


@dataclass(frozen=True, slots=True)
class ShapeLearningParams:
    """When and how fast the body shape is learned while tracking."""

    learn: bool = True
    # weight of a frame's information for later frames, by measurement: docs/decisions/shirt-tracker.md
    gain: float = 1.2
    learning_s: float = 6.0  # proportions settle over the first seconds of good tracking
    least_match: float = 0.7  # match of a frame from which it is learned


@dataclass(frozen=True, slots=True)
class ShirtParams:
    """Parameters of the shirt cue."""

    fit: FitParams = field(default_factory=FitParams)
    limbs: LimbSearchParams = field(default_factory=LimbSearchParams)
    segmentation: SegmentationParams = field(default_factory=SegmentationParams)
    shape: ShapeLearningParams = field(default_factory=ShapeLearningParams)
    # points by the hundred share the errors of cloth and surface: together they count as three would alone
    distances: StereoMatchParams = field(default_factory=lambda: StereoMatchParams(sd_m=0.27))

    arm_depths: float = 0.5  # weight of the keypoints' depths for arms before a single camera

    # motion from frame to frame

    # decisions
    live_match: float = 0.45  # share of rendered shirt pixels whose colour the picture has
    accept_match: float = 0.58  # the same, to accept a new pose
    accept_colours: int = 5  # colours that must be confirmed to accept a new pose
    min_shirt_px: int = 120  # confirmed work px, all cameras together
    # a lower match starts a search of all pictures while tracking goes on
    uncertain_match: float = 0.6
    uncertain_pause_s: float = 0.4  # between such searches
    uncertain_gain: float = 0.05  # by which the match must be better to replace the track
    search_pause_s: float = 0.1  # between attempts that failed, while no person is tracked
    # between searches on a body that clothes place: at least, at most, and as a share of how long the shirt is missing
    covered_pause_s: float = 0.2
    most_covered_pause_s: float = 1.0
    covered_share: float = 0.25
    # trunks nearer than this are one body: errors of cloth, shape and lag stay below it
    near_m: float = 0.3
    neighbours: int = 6  # of the pose database, per camera
