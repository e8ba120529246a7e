"""The numbers of the published tracker with the visual hull, with units and reasons."""

from dataclasses import dataclass, field

from mocapd.published.rao_hodges.annealing import AnnealingParams
from mocapd.vision.hull.ray_hull import RayHullParams
from mocapd.vision.room_background import BackgroundParams


@dataclass(frozen=True, slots=True)
class RootParams:
    """The root is given in the paper. Here it is the trunk's, searched for like a limb."""

    # of the top layer's noise per second of the time between frames: a third of 1.8 m/s
    sd_m: float = 0.6
    sd_rad: float = 1.6  # likewise
    yaws: int = 24  # directions that are tried at the start
    raised_rad: tuple[float, ...] = (0.0, 0.6, 1.2, 1.45)  # arms below the T-pose that are tried
    refinements: int = 4  # searches at one frame, from the first guess
    refinement_dt_s: float = 1.0 / 30.0  # time between frames that each of them assumes


@dataclass(frozen=True, slots=True)
class Params:
    """Parameters of the published tracker. converse: exponent of the term against empty ellipsoids, for limbs; 0 as
    published. root_converse: likewise, for root and start."""

    annealing: AnnealingParams = field(default_factory=AnnealingParams)
    converse: float = 0.0
    root_converse: float = 1.0
    root: RootParams = field(default_factory=RootParams)
    hull: RayHullParams = field(default_factory=RayHullParams)
    # while no person is tracked: most of a room's points are in view of hardly any camera
    room_hull: RayHullParams = field(default_factory=lambda: RayHullParams(rays=2000, points=10000))
    background: BackgroundParams = field(default_factory=BackgroundParams)
    seed: int = 0
    work_width_px: int = 320

    # what space is looked at
    room_m: float = 2.5  # to each side of the place that all cameras look at
    about_m: float = 1.2  # to each side of the person that is followed
    height_m: float = 2.6

    # losing
    least_inside: float = 0.05  # share of the points that a believed body contains
    least_full: float = 0.4  # how full its ellipsoids are on average
    too_old_s: float = 1.0  # a pose is not carried on over a longer gap

    # background
    beside_px: int = 12  # about the body nothing is learned as background [work px]
    # distance from an adopted body beyond which the picture is background [work px]
    close_px: int = 1
    least_contrast: float = 1.3  # outline contrast of an adopted body, which hides its background
    uncovered_looks: int = 10  # from one search for uncovered background to the next
    # one look of so many also learns the foreground while no person is tracked
    absorb_looks: int = 13
