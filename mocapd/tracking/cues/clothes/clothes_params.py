"""Parameters of the clothes cue and its parts, with units and reasons."""

from dataclasses import dataclass, field

from mocapd.fit.fit_params import FitParams, LegSearchParams, LimbSearchParams
from mocapd.fit.stereo_depth import StereoDepthParams
from mocapd.fit.terms.floor_term import CROSSING_VIEWS, FloorParams
from mocapd.fit.terms.joint_term import JointTermParams
from mocapd.fit.terms.stereo_match_term import StereoMatchParams
from mocapd.tracking.cues.clothes.appearance import AppearanceParams
from mocapd.tracking.hypotheses.keypoint_poses import KeypointPoseParams
from mocapd.tracking.planted_feet import PlantedFeetParams
from mocapd.vision.room_background import BackgroundParams


@dataclass(frozen=True, slots=True)
class KeypointDetectionParams:
    """What the network's maps are worth."""

    term: JointTermParams = field(default_factory=JointTermParams)
    blur_cells2: float = 0.64  # variance that the maps were trained to have where a joint is sure
    least_cells2: float = 0.16  # of a joint, however sure
    laplace: float = 1.6  # standard deviation of depths, in scales of their distribution
    least_depth_m: float = 0.04
    inside_cells: float = 0.5  # from the border of the maps, nearer to which a joint may be outside


@dataclass(frozen=True, slots=True)
class StartParams:
    """When a foreground blob counts as a person, and how the first pose is found."""

    least_px: int = 400  # of a blob, in work pixels
    least_height_px: int = 50
    most_share: float = 0.4  # of a picture that is not its background, in a camera that counts
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
    # of how far the network spreads head and neck over their maps, in the camera where that is smallest: of people in
    # recordings up to 0.045, in a real video up to 0.054, of moved chairs, plants and cupboards from 0.066
    head_spread_m: float = 0.06
    # of such agreement, that a person one metre farther away must have more
    farther_per_m: float = 0.08
    elsewhere_per_m: float = 0.3  # likewise, away from where somebody was tracked a moment ago
    people: int = 2  # candidates that are fitted; the best one is taken
    # between the facing of fit and keypoints, above which the body is turned and fitted with keypoints, too, where silhouette
    # and body then agree better; and above which it is turned about unless they agree by so much less
    turned_rad: float = 0.25
    turned_about_rad: float = 1.6
    turned_less: float = 0.15
    longest_s: float = 0.5  # of a search in one frame set, before it continues in the next
    walked_m: float = 1.0  # by the person during the search, at most
    # since the person was tracked last: who is farther away is somebody else
    walks_m_s: float = 1.5
    pause_s: float = 0.2  # between attempts that failed
    # a slower piece is followed by a pause as long as itself, at most this
    most_rest_s: float = 2.0


@dataclass(frozen=True, slots=True)
class HullStartParams:
    """Which part of the visual hull may be a person."""

    cameras: int = 3  # least number of them, also in whose view a place is
    half_width_m: float = 3.0  # of the space that is searched, about where the cameras look
    low_m: float = 0.12  # its lower edge: light and shadows lie on the floor
    high_m: float = 2.3
    voxel_m: float = 0.08
    # log-odds of the person, by what a pixel shows; one camera's background outweighs three others' foreground
    before: float = 2.0
    shadow: float = 0.5
    background: float = -3.0
    least_high_m: float = 0.16  # of the hull above a place of the floor,
    arms_m: float = 0.5  # unless it reaches above this
    least_m3: float = 0.02  # a person has 0.07, and the hull of three cameras twice that
    most_m3: float = 0.6
    people: int = 3  # candidates


@dataclass(frozen=True, slots=True)
class KeypointStartParams:
    """When keypoints and a silhouette count as a person."""

    least_height_px: int = 16  # of a blob: a lying person is low [work px]
    step_m: float = 0.1  # between the distances that are tried
    # of the error of a blob's lower edge, relative to that of its centre
    bottom_weight: float = 0.15
    middle_sd_m: float = 0.5  # of the first guess of the hips' place
    looks: int = 2  # passes of the network, the second about the pose of the first
    iterations: int = 6  # of the fit to the keypoints alone
    explained: float = 0.62  # of silhouette and body together
    shadows_more: float = 0.08  # with what may be shadow: it lies on the floor before the feet, and draws the body there
    # see KeypointCandidate
    spread_m: float = 0.09  # of people up to 0.07, of chairs from 0.11
    # the same, above which a camera's keypoints are left out: the first crop may be off-centre
    hopeless_m: float = 0.15
    # of people up to 1.0; of lying people, which the network has not learned, to 4
    off_sds2: float = 1.3
    apart_m: float = 0.3  # of people up to 0.25, with adjacent cameras; of a bookshelf from 0.4
    least_joints: int = 10  # of 15, detected inside each picture
    lowest_m: tuple[float, float] = (-0.15, 0.3)  # the lowest joint, above the floor
    same_place_m: float = 0.4  # between two successive searches


@dataclass(frozen=True, slots=True)
class RoomScanParams:
    """Where and how often the network looks for somebody without a background."""

    step_m: float = 0.6  # between places: it sees people half a metre beside the middle of its crop
    nearest_m: float = 1.2  # from a camera
    farthest_m: float = 5.0
    middle: float = 0.55  # height of the crop's middle [statures]
    margin: float = 0.05  # of a picture: places closer to its edge are not looked at
    looks: int = 2  # at somebody in a frame set, each about the pose of the one before
    sets: int = 6  # frame sets in a row that look at somebody
    # spread of the keypoints [m]: of people half a metre beside the place mostly less, of other places from 0.2
    hopeless_m: float = 0.15
    spread_m: float = 0.1  # of the pose that is found: of people to 0.1, of bookshelves from 0.115
    # of somebody's silhouette, in one camera, that has left the place where it was learned as background
    moving_share: float = 0.02
    places: int = 4  # in a frame set
    # without a person, before the first place: who walks in is found in the foreground by then, and better
    patience_s: float = 1.0
    first_patience_s: float = 0.3  # since the room was learned: who is there already does not walk in, and has moved by then
    pause_s: float = 1.0  # after all places, twice as long after each round
    longest_pause_s: float = 30.0


@dataclass(frozen=True, slots=True)
class MotionMonitorParams:
    """When motion in the foreground counts as an undetected person."""

    least_px: int = 500  # of a camera's foreground [work px]
    most_share: float = 0.6  # of the picture: more is another light
    moved_px: int = 40  # that changed between background and foreground since the last search
    # the same, of the foreground: the edge of a moved chair flickers less
    moved_share: float = 0.03
    cameras: int = 2  # that must show it
    lasts_s: float = 2.0  # of such motion: by then a person entering the room is found
    rest_s: float = 1.5  # without motion, that ends it


@dataclass(frozen=True, slots=True)
class ClothesParams:
    """Parameters of the clothes cue."""

    fit: FitParams = field(default_factory=lambda: FitParams(iterations=6, close_sds=0.5))
    # learned colours confirm less than the shirt's; hands belong to the forearm's region
    limbs: LimbSearchParams = field(
        default_factory=lambda: LimbSearchParams(
            uncertain_arm=0.55, hand_px=0.0, hand_cost=0.0, exchange_turns=4
        )
    )
    legs: LegSearchParams = field(default_factory=LegSearchParams)
    background: BackgroundParams = field(default_factory=BackgroundParams)
    appearance: AppearanceParams = field(default_factory=AppearanceParams)
    start: StartParams = field(default_factory=StartParams)
    room_scan: RoomScanParams = field(default_factory=RoomScanParams)
    hull_start: HullStartParams = field(default_factory=HullStartParams)
    keypoint_start: KeypointStartParams = field(default_factory=KeypointStartParams)
    motion_monitor: MotionMonitorParams = field(default_factory=MotionMonitorParams)
    floor: FloorParams = field(default_factory=FloorParams)
    floor_before_crossing_views: FloorParams = CROSSING_VIEWS
    feet: PlantedFeetParams = field(default_factory=PlantedFeetParams)
    depths: StereoDepthParams = field(default_factory=StereoDepthParams)
    joints: KeypointDetectionParams = field(default_factory=KeypointDetectionParams)
    keypoint_poses: KeypointPoseParams = field(default_factory=KeypointPoseParams)
    distances: StereoMatchParams = field(
        default_factory=lambda: StereoMatchParams(points=10, leg_points=24)
    )

    margin_px: int = 26  # about the predicted body, that is classified [work px]
    # of the region about the predicted body, that is foreground beside it, in a camera that somebody covers: of people near
    # others up to 0.4, of those who pass close to a lens from 0.6
    covered_share: float = 0.5
    beside_px: int = 15  # about the body, that the background does not learn
    moved_px: int = 7  # by which somebody may have moved since the room was learned with them
    # of a body that looks like the room: who stood there when it was learned 0.2 to 0.97, who walked in to 0.18
    stood: float = 0.2
    close_px: int = 3  # the same of pixels that have no background yet
    uncovered_s: float = 10 / 30  # between two searches for ghosts
    # interval at which the background learns the foreground, too, while no person is tracked
    absorb_s: float = 13 / 30
    # log-odds of the network, above which what looks like the room is a person in clothes of its colour
    room_coloured: float = 0.4
    soft: float = 60.0 / 255.0  # weight of a rendered pixel in the foreground of another region

    # motion from frame to frame
    sure_to_hand: float = (
        0.6  # share of an arm and of its forearm confirmed, from which on it is where views cross
    )

    # decisions
    live_explained: float = (
        0.45  # share of rendered and classified pixels that agree, for the pose to be accepted
    )
    least_body_px: int = 300  # confirmed work px, all cameras together
    # `outline_contrast` of a body from another tracker, to start from it
    least_contrast: float = 1.2
    learn_explained: float = 0.45  # of a frame set from which colours are learned
    alike: float = 0.55  # overlap of two regions' colours above which they are merged

    # with trunk and arms from the shirt
    guided_iterations: int = 3
    guided_joints_s: float = 3 / 30  # between two keypoint detections
    guided_look_s: float = 4 / 30  # between two updates of one camera's appearance model
    new_legs_s: float = 1.0  # legs as new as this never rest, and have keypoints of all cameras
    guided_sd_m: float = 0.01
    guided_depth_sd_m: float = 0.015  # along the line of sight of a single camera
    guided_sd_rad: float = 0.03

    # the first legs below a trunk from the shirt
    first_keypoints_s: float = 9 / 30  # between two attempts by keypoints,
    first_silhouettes_s: float = 3 / 30  # and by silhouettes: no body is uncovered within a frame
    first_spread_m: float = 0.12  # of knees and ankles: seen up to 0.10, behind a desk from 0.18
