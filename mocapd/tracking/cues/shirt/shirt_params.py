"""The numbers of the shirt cue's own decisions, and those of its parts, with units and reasons."""

from dataclasses import dataclass, field

from mocapd.fit.fit_params import FitParams, LimbSearchParams, MotionPriorParams
from mocapd.fit.terms.stereo_match_term import StereoMatchParams
from mocapd.shirt.segmentation.segmentation_params import SegmentationParams
from mocapd.tracking.velocity import VelocityParams


@dataclass(frozen=True, slots=True)
class ShapeLearningParams:
    """When the proportions are learned while tracking, and how fast."""

    learn: bool = True
    gain: float = 0.6  # share of a frame's information kept: errors last over frames
    learning_s: float = 6.0  # proportions settle over the first seconds of good tracking
    least_match: float = 0.7  # agreement of a frame that teaches


@dataclass(frozen=True, slots=True)
class ShirtParams:
    """Parameters of the full tracker: its parts', and what it decides itself."""

    fit: FitParams = field(default_factory=FitParams)
    motion: MotionPriorParams = field(default_factory=MotionPriorParams)
    limbs: LimbSearchParams = field(default_factory=LimbSearchParams)
    segmentation: SegmentationParams = field(default_factory=SegmentationParams)
    shape: ShapeLearningParams = field(default_factory=ShapeLearningParams)
    # points by the hundred share the errors of cloth and surface: together they count as three would alone
    distances: StereoMatchParams = field(default_factory=lambda: StereoMatchParams(sd_m=0.27))

    # motion from frame to frame
    velocity: VelocityParams = field(default_factory=VelocityParams)

    # decisions
    live_match: float = 0.45  # share of rendered shirt pixels whose colour the picture has
    accept_match: float = 0.58  # the same, to accept a new pose
    accept_colours: int = 5  # colours that must be confirmed to accept a new pose
    min_shirt_px: int = 120  # confirmed work px, all cameras together
    uncertain_match: float = (
        0.6  # under this agreement the shirt is looked for anew beside tracking
    )
    uncertain_pause_s: float = 0.4  # between such looks
    uncertain_gain: float = 0.05  # by how much the agreement must be better to change over
    search_pause_s: float = 0.1  # between attempts that failed, while nobody is known
    covered_pause_s: float = 0.2  # between looks at a body that clothes carry
    near_m: float = (
        0.3  # trunks nearer than this are of one body: cloth, shape and lag together stay below it
    )
    neighbours: int = 6  # of the pose database, per camera
