"""What the maps of the network are worth."""

from dataclasses import dataclass, field

from mocapd.fit.terms.joint_term import JointTermParams


@dataclass(frozen=True, slots=True)
class KeypointDetectionParams:
    """What the network's maps are worth."""

    term: JointTermParams = field(default_factory=JointTermParams)
    blur_cells2: float = 0.64  # variance that the maps were trained to have where a joint is sure
    least_cells2: float = 0.16  # of a joint, however sure
    laplace: float = 1.6  # standard deviation of depths, in scales of their distribution
    least_depth_m: float = 0.04
    inside_cells: float = 0.5  # from the border of the maps, nearer to which a joint may be outside
