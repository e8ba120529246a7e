"""Parameters of the solver and of the limb search, with units and reasons."""

from dataclasses import dataclass

TICK_S = 1.0 / 30.0  # nominal frame period: parameters per frame refer to it


@dataclass(frozen=True, slots=True)
class FitParams:
    """Parameters of the fit; work pixels are those of frames averaged down to `work_width_px`."""

    work_width_px: int = 320

    # alignment
    iterations: int = 4
    first_radius_px: int = 14  # search radius of the first and the last iteration [work px]
    last_radius_px: int = 7
    # the last ones, at all work pixels; the others at every second each way
    fine_iterations: int = 2
    # where views cross, a step by less goes on to all work pixels [spreads of a prediction]; 0: none does
    close_sds: float = 0.0
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
    small_baseline_rad: float = 0.26  # largest angle between the views of a small baseline
    tilt_sd_rad: float = 0.25  # of the hips, with a small baseline

    depth_off_m: float = 0.10  # of the drawn from the measured depth: another object
    # search radius for a drawn pixel of the measured depth: a patch's half [work px]
    depth_around_px: int = 2
    depth_cost: float = 1.0  # of a pixel at another depth [disagreeing pixels]
    # tolerated share of an area at another depth: the outlines of a limb have the depth of the background
    depth_usual: float = 1.6  # factor on the agreeing share of an area
    depth_least_px: int = 16  # least compared pixels of an area

    @property
    def collision_information(self) -> float:
        """Of a depth in the trunk [1/m^2]."""
        return 1.0 / self.collision_sd_m**2


@dataclass(frozen=True, slots=True)
class LimbSearchParams:
    """When the search tries other poses of an arm, and how many."""

    # share of an arm's pixels confirmed, below which others are tried
    uncertain_arm: float = 0.45
    uncertain_arm_small_baseline: float = 0.45
    nearer_px: float = 100.0  # well in front of the body, above which both arms are uncertain
    arm_cloud: int = 64  # samples about the present pose
    arm_library: int = 128  # tries over the whole range, another part each frame
    arm_reaches: int = 48  # hand targets in front of the body
    arm_fits: int = 2  # the best samples, refined by a fit
    farther_px: float = 5.0  # cost of the distance from the present pose [disagreeing pixels/rad^2]
    # share of an arm's area over background that rejects a pose; the main evidence with a small baseline
    empty: float = 0.25
    empty_small_baseline: float = 0.5
    # cost of an unusual pose by its squared Mahalanobis distance: in the image score [work px], and in the cost of its fit
    unusual_px: float = 1.4
    unusual_cost: float = 1.0
    hand_px: float = 1.0  # weight of a hand's skin pixel against a pixel of the arm
    hand_cost: float = 1.0  # the same in the cost of a fit
    arm_gain: float = 10.0  # by how much the cost must fall to change over [disagreeing pixels]
    # turns between attempts to exchange the arms, in turns with stereo depth; 0: never
    exchange_turns: int = 0


@dataclass(frozen=True, slots=True)
class LegSearchParams:
    """When the search tries other poses of a leg, and how many."""

    # share of its worse part's pixels confirmed, below which others are tried
    uncertain: float = 0.5
    cloud: int = 48  # samples about the present pose
    library: int = 96  # tries over the range of legs, another part each frame
    fits: int = 2  # the best samples, refined by a fit
    farther_px: float = 5.0  # cost of the distance from the present pose [px/rad^2]
    empty: float = 0.5  # share of a leg's area before background that denies it
    unusual_px: float = 1.4  # cost of an unusual pose by its squared Mahalanobis distance
    unusual_cost: float = 1.0  # the same in the cost of a fit
    # such a distance, above which more counts ever less: legs of a squat have 50 to 200
    tail: float = 25.0
    squats: int = 3  # of so many tries over the range one is of a deep squat
    gain: float = 10.0  # by how much the cost must fall to change over [disagreeing pixels]
