"""Numbers of the limbs' scores and their particles, with units and reasons."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class LimbScoreParams:
    """What samples count; penalties are 0..1, 1 the worst."""

    along: int = 10  # rows of the grid on a part, and samples on each of its long edges
    across: int = 4  # columns of the grid
    # of the mean penalty of all samples of a limb in one view, in units of the logarithm of a likelihood
    edge_weight: float = 20.0
    surface_weight: float = 20.0
    # sum of differences of B, G, R at which a colour is wrong altogether, of 765; 765: [Hecht 2009]
    colour_cap: float = 60.0
    # by how much of its brightness a colour may be off, as limbs are round; 0: [Hecht 2009]
    shading: float = 0.5
    # Penalty of a hidden sample, in addition to the limb's median penalty of visible samples. The median differs from
    # limb to limb (over true poses in six captures: edges of arms 0.16, of legs 0.23; surfaces 0.49 and 0.14), so
    # no fixed value suits all. At 0.07 to 0.10 above the median as many true poses are above as poses 20 cm off are
    # below. But a filter selects the best of many particles, and the best of half-hidden ones is better than the
    # median: with 0.07 limbs hid or pointed at the camera, with 0.15 they did so the least (arms of a wide pair 9 cm
    # instead of 32), with 0.25 and more hidden limbs moved into view.
    usual: tuple[float, float] = (0.33, 0.27)  # of edges and surface, before a limb has its own
    hidden_surplus: float = 0.15
    # time constant at which a limb's own are learned
    usual_s: float = 2.0
    # by how much a part must be nearer to hide: joints of limb and trunk are as far
    hidden_by_m: float = 0.05
    cell_px: float = 8.0  # of the grid in which parts that hide are looked up
    occlusion: bool = True  # off: as if no part hid another
    appearance: bool = True  # off: edges alone


@dataclass(frozen=True, slots=True)
class LimbMotionParams:
    """How particles move and scatter. Points in the order from the trunk outwards."""

    velocity_share: float = 0.65  # eta: 0.5 to 0.8 [Hecht 2009, section III.A]
    depth_share: float = 0.25  # alpha: of the particles that scatter along the viewing ray
    depth_sd_m: tuple[float, float, float] = (
        0.15,
        0.5,
        1.0,
    )  # of those, a search: whatever the time between
    base_sd_m: float = 0.008  # over 1/30 s, growing with the square root of time
    variance_share: float = 0.1  # of a point's variance over 1/30 s, in proportion to time
    most_sd_m: float = 0.3  # of that variance: a lost limb must not feed its own noise
    # A hand goes 2 m/s in lively gestures and turns round within a tenth of a second
    motion_sd_m_s: float = 1.5  # where everything moves in the picture
    full_motion: float = 0.25  # of the motion image, from which on everything moves: arms are thin
    depth_noise: bool = True  # off: the first distribution alone
