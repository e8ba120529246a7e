"""Numbers of the solver and of the search for lost arms, with units and reasons."""

from dataclasses import dataclass

TICK_S = 1.0 / 30.0  # a usual frame: what is said per frame is meant for one of this length


@dataclass(frozen=True, slots=True)
class FitParams:
    """Parameters of the fit; work pixels are those of frames averaged down to `work_width_px`."""

    work_width_px: int = 320

    # alignment
    iterations: int = 4
    first_radius_px: int = 14  # search radius of the first and the last iteration [work px]
    last_radius_px: int = 7
    fine_iterations: int = (
        2  # the last ones, at all work pixels; the others at every second each way
    )
    edge_weight: float = 1.0  # weight of an edge in place against a pixel that disagrees, fine
    row_weight: float = 0.06  # inverse variance of a pixel's residual; neighbours are correlated

    # motion: spread about the prediction over 1/30 s, growing with the square root of time
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
    collision_sd_m: float = 0.015  # softness of the trunk, for arms that would go into it
    limit_sd_rad: float = 0.08  # softness of the joint limits
    small_baseline_rad: float = 0.26  # between the views, under which cameras count as one
    tilt_sd_rad: float = 0.25  # of the hips, before such cameras

    depth_off_m: float = 0.10  # of what is drawn from what is seen: it is another thing
    depth_around_px: int = (
        2  # within which that is which has the depth seen in a pixel: a patch's half [work px]
    )
    depth_cost: float = 1.0  # of a pixel that is, beside one that disagrees
    # what may be off of an area that is where it is seen: the outlines of a limb have the depth of what is behind it
    depth_usual: float = 1.6  # so many times its share that is not off confirms it
    depth_least_px: int = 16  # compared, for an area to be judged by it

    @property
    def collision_information(self) -> float:
        """Of a depth in the trunk [1/m^2]."""
        return 1.0 / self.collision_sd_m**2


@dataclass(frozen=True, slots=True)
class MotionPriorParams:
    """How much a wearer moves from one usual frame to the next: these, and so many times the step before."""

    calm_m: float = 0.003
    calm_rad: float = 0.01
    calm_gain: float = 2.0
    hidden_sd_rad: float = 0.06  # of an arm that no picture confirms


@dataclass(frozen=True, slots=True)
class LimbSearchParams:
    """When other poses of an arm are tried, and how many."""

    uncertain_arm: float = 0.45  # share of an arm's pixels confirmed, below which others are tried
    nearer_px: float = 100.0  # where something is seen well before the body, above which both are
    arm_cloud: int = 64  # tries about the present pose
    arm_library: int = 128  # tries over the whole range, another part each frame
    arm_reaches: int = 48  # hands tried where something is seen before the body
    arm_fits: int = 2  # of which so many are fitted
    farther_px: float = (
        5.0  # how much more must speak for a pose that is farther away [disagreeing pixels/rad^2]
    )
    # share of an arm's area before background that denies it; where all cameras look from one side, little else does
    empty: float = 0.25
    empty_small_baseline: float = 0.5
    # what a pose costs that arms seldom have, by its squared Mahalanobis distance: of what is seen of it [work px], and
    # in the cost of its fit
    unusual_px: float = 1.4
    unusual_cost: float = 1.0
    hand_px: float = (
        1.0  # what a hand's pixel that is skin, or is not, counts beside one of the rest of the arm
    )
    hand_cost: float = 1.0  # the same beside the cost of a fit
    arm_gain: float = 10.0  # by how much the cost must fall to change over [disagreeing pixels]
    # from one try of each where the other is to the next, in turns that know depths, which tell look-alikes apart; 0: never
    exchange_turns: int = 0


@dataclass(frozen=True, slots=True)
class LegSearchParams:
    """When other poses of a leg are tried, and how many."""

    uncertain: float = (
        0.5  # share of its worse part's pixels confirmed, below which others are tried
    )
    cloud: int = 48  # tries about the present pose
    library: int = 96  # tries over the range of legs, another part each frame
    fits: int = 2  # of which so many are fitted
    farther_px: float = 5.0  # how much more must speak for a pose that is farther away [px/rad^2]
    empty: float = 0.5  # share of a leg's area before background that denies it
    unusual_px: float = (
        1.4  # what a pose costs that legs seldom have, by its squared Mahalanobis distance
    )
    unusual_cost: float = 1.0  # the same in the cost of a fit
    tail: float = (
        25.0  # such a distance, above which more counts ever less: legs of a squat have 50 to 200
    )
    squats: int = 3  # of so many tries over the range one is of a deep squat
    gain: float = 10.0  # by how much the cost must fall to change over [disagreeing pixels]
