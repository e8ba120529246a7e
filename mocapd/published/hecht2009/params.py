"""The numbers of the published tracker without a shirt, with units and reasons."""

from dataclasses import dataclass, field

from mocapd.published.hecht2009.cylinders.limb_params import (
    LimbMotionParams,
    LimbScoreParams,
)
from mocapd.published.hecht2009.mass_spring.simulation import SimulationParams
from mocapd.vision.room_background import BackgroundParams

FLOOR_M = 0.0  # y of the world's floor


@dataclass(frozen=True, slots=True)
class Params:
    """Parameters of the published tracker."""

    particles: int = 200  # of each limb [Hecht 2009, section IV.A]
    particle_constraints: bool = True
    seed: int = 0
    motion: LimbMotionParams = field(default_factory=LimbMotionParams)
    score: LimbScoreParams = field(default_factory=LimbScoreParams)
    background: BackgroundParams = field(default_factory=BackgroundParams)
    simulation: SimulationParams = field(default_factory=SimulationParams)
    work_width_px: int = 320
    sure_m: float = 0.10  # spread of a point at which it teaches 1/e as much of its colour

    # initialisation with the body that hangs from the head
    match_edge: float = 0.45  # mean edge penalty 0..1 of hanging limbs on a person
    match_before: float = 0.6  # share of the body that stands before the background
    # sideways angles of the arms in the initial search: people show a T-pose, or hold hands apart
    raised_rad: tuple[float, ...] = (0.0, 0.2, 0.4, 0.8, 1.2, 1.57)
    rehang_m: float = 0.3  # motion of the head between two pictures that means another person
    rehang_rad: float = 0.6  # by which the face may turn from where the body was hung

    # losing
    most_edge: float = 0.65  # mean edge penalty of a body that is believed
    least_before: float = 0.4  # share of a believed body that stands before the background
    too_old_s: float = 1.0  # a pose is not carried on over a longer gap

    # background
    beside_px: int = 15  # about the body nothing is learned as background [work px]
    uncovered_turns: int = 10  # from one look for what was uncovered to the next
    # one look of so many also learns the foreground while no body is tracked
    absorb_turns: int = 13
