"""What a user may set of the published tracker without a shirt."""

from dataclasses import dataclass
from typing import Annotated

from msgspec import Meta


@dataclass(frozen=True, slots=True)
class FlexPaperSection:
    """How many particles, and which of the paper's steps are taken.

    particles: of each limb
    depth_noise: some particles scatter along the viewing ray
    particle_constraints: particles are pulled to states that a body can take
    occlusion: parts of the body hide each other
    appearance: colours of the parts are learned and compared; without, edges alone
    """

    particles: Annotated[int, Meta(ge=10, le=5000)] = 200
    depth_noise: bool = True
    particle_constraints: bool = True
    occlusion: bool = True
    appearance: bool = True
