"""Parameters of the clothes cue and its parts, with units and reasons."""

from dataclasses import dataclass, field

from mocapd.fit.fit_params import FitParams, LegSearchParams, LimbSearchParams, MotionPriorParams
from mocapd.fit.stereo_depth import StereoDepthParams
from mocapd.fit.terms.floor_term import FloorParams
from mocapd.fit.terms.planted_term import PlantedParams
from mocapd.fit.terms.stereo_match_term import StereoMatchParams
from mocapd.tracking.cues.clothes.appearance import AppearanceParams
from mocapd.tracking.cues.keypoints.keypoint_detection_params import KeypointDetectionParams
from mocapd.tracking.hypotheses.foot_heading import FootHeadingParams
from mocapd.tracking.hypotheses.front_back_flip import FlipParams
from mocapd.tracking.hypotheses.keypoint_starts import KeypointPoseParams
from mocapd.tracking.hypotheses.limb_swap import LimbSwapParams
from mocapd.tracking.hypotheses.pelvis_heading import PelvisHeadingParams
from mocapd.tracking.planted_feet import PlantedFeetParams
from mocapd.tracking.velocity import VelocityParams
from mocapd.vision.room_background import BackgroundParams


@dataclass(frozen=True, slots=True)
class StartParams:
    """When a foreground blob counts as a person, and how the first pose is found."""

    least_px: int = 400  # of a blob, in work pixels
    least_height_px: int = 50
    most_share: float = 0.6  # of a picture that is not its background, in a camera that counts
    nearest_m: float = 1.2
    farthest_m: float = 6.0
    step_m: float = 0.05
    blobs: int = 3  # in each picture, the largest
    arms_rad: tuple[float, ...] = (0.0, -0.7, -1.2)  # how far below the T-pose both are tried
    rough_iterations: int = 4
    refined: int = 2  # of the roughly fitted
    iterations: int = 6
    loose_s: float = 0.4  # how far the fit may move from where it begins, as a time of motion
    accept_explained: float = 0.75  # of silhouette and body together
    likely_explained: float = 0.6  # the same, at two attempts in a row
    same_place_m: float = 0.4  # between which the person moved no more than this
    # median over the joints of how far the network spreads each over its map, in the camera where that is smallest: of
    # people in sixty simulated sessions up to 0.057, in a real video up to 0.09, of plants and chairs from 0.11
    spread_m: float = 0.1
    farther_per_m: float = (
        0.08  # of such agreement a person who is a metre farther away must have more
    )
    people: int = 2  # of whom the best is taken
    longest_s: float = 0.5  # of a look at one frame set, before it goes on at the next
    walked_m: float = 1.0  # by somebody meanwhile, at most
    pause_s: float = 0.2  # between attempts that failed
    most_rest_s: float = 2.0  # after a step that took longer than that, for as long as it took


@dataclass(frozen=True, slots=True)
class KeypointStartParams:
    """When keypoints and a silhouette count as a person."""

    least_height_px: int = 16  # of a piece: who lies is low [work px]
    step_m: float = 0.1  # from one distance that is tried to the next
    bottom_weight: float = 0.15  # of a piece's lower edge on the floor, beside its middle
    middle_sd_m: float = 0.5  # of the first guess of the hips' place
    looks: int = 2  # of the network, the second about the pose that came of the first
    iterations: int = 6  # towards the joints
    explained: float = 0.62  # of silhouette and body together
    shadows_more: float = 0.08  # with what may be shadow: it lies on the floor before the feet, and draws the body there
    # see KeypointCandidate
    spread_m: float = 0.09  # of people up to 0.07, of chairs from 0.11
    hopeless_m: float = (
        0.15  # the same, above which nothing is fitted: at the first look the middle may be off
    )
    off_sds2: float = 1.3  # of people up to 1.0; of who lies, whom the network does not know, to 4
    apart_m: float = (
        0.3  # of people up to 0.25, before cameras beside each other; of a bookshelf from 0.4
    )
    least_joints: int = 10  # of 15, seen inside each picture
    lowest_m: tuple[float, float] = (-0.15, 0.3)  # the lowest joint, above the floor
    same_place_m: float = 0.4  # between two looks in a row


@dataclass(frozen=True, slots=True)
class MotionMonitorParams:
    """When motion must come from a person who is not found."""

    least_px: int = 500  # of all that is before the background of a camera, in work pixels
    most_share: float = 0.6  # of the picture: more is another light
    moved_px: int = (
        40  # that are before it now and were not at the look before, or were and are not
    )
    moved_share: float = (
        0.03  # the same, of all that is before it: the edge of a chair that was moved flickers less
    )
    cameras: int = 2  # in which it does
    lasts_s: float = (
        2.0  # from the first such look to the last: somebody who walks in is found by then
    )
    rest_s: float = 1.5  # without one, and it has ended


@dataclass(frozen=True, slots=True)
class ClothesParams:
    """Parameters of the clothes cue."""

    fit: FitParams = field(default_factory=lambda: FitParams(iterations=6))
    motion: MotionPriorParams = field(default_factory=MotionPriorParams)
    # colours that are learned confirm less than the shirt's; hands are of the forearm's region
    limbs: LimbSearchParams = field(
        default_factory=lambda: LimbSearchParams(hand_px=0.0, hand_cost=0.0, exchange_turns=4)
    )
    legs: LegSearchParams = field(default_factory=LegSearchParams)
    background: BackgroundParams = field(default_factory=BackgroundParams)
    appearance: AppearanceParams = field(default_factory=AppearanceParams)
    start: StartParams = field(default_factory=StartParams)
    keypoint_start: KeypointStartParams = field(default_factory=KeypointStartParams)
    motion_monitor: MotionMonitorParams = field(default_factory=MotionMonitorParams)
    floor: FloorParams = field(default_factory=FloorParams)
    planted: PlantedParams = field(default_factory=PlantedParams)
    feet: PlantedFeetParams = field(default_factory=PlantedFeetParams)
    flip: FlipParams = field(default_factory=FlipParams)
    limb_swap: LimbSwapParams = field(default_factory=LimbSwapParams)
    depths: StereoDepthParams = field(default_factory=StereoDepthParams)
    joints: KeypointDetectionParams = field(default_factory=KeypointDetectionParams)
    keypoint_poses: KeypointPoseParams = field(default_factory=KeypointPoseParams)
    pelvis_heading: PelvisHeadingParams = field(default_factory=PelvisHeadingParams)
    foot_heading: FootHeadingParams = field(default_factory=FootHeadingParams)
    distances: StereoMatchParams = field(
        default_factory=lambda: StereoMatchParams(points=10, leg_points=24)
    )

    margin_px: int = 26  # about the predicted body: as far as its regions are looked for [work px]
    beside_px: int = 15  # about the body nothing is learned as background
    close_px: int = 3  # but what was never known as such, beyond that
    uncovered_s: float = 10 / 30  # from one look for what was uncovered to the next
    absorb_s: float = (
        13 / 30
    )  # so often what stands before the background is learned, too, while nobody is known
    soft: float = (
        60.0 / 255.0
    )  # weight of a drawn pixel where something else stands before the background

    # motion from frame to frame
    velocity: VelocityParams = field(default_factory=VelocityParams)

    # decisions
    live_explained: float = (
        0.45  # share of drawn and seen pixels that agree, for the pose to be believed
    )
    least_body_px: int = 300  # confirmed work px, all cameras together
    least_contrast: float = (
        1.2  # of the outline of a body that is taken over, against what is beside it
    )
    learn_explained: float = 0.45  # of a frame that teaches colours
    alike: float = 0.55  # share of two regions' colours that is the same, above which they are one

    # with the upper body known from another tracker
    guided_iterations: int = 3
    guided_joints_s: float = 3 / 30  # from one look for joints to the next
    guided_look_s: float = (
        4 / 30
    )  # from one frame that teaches the look of the clothes to one camera to the next
    guided_joint_after_s: float = 1.0  # since the legs were found
    guided_sd_m: float = 0.01
    guided_sd_rad: float = 0.03
