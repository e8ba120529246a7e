"""From the goal's frame to Panda3D's: the only place of this game where axes change.

| frame | right-handed, axes for who looks from the goal to the field |
|---|---|
| goal | +X left, +Y up, +Z away |
| Panda3D | +X right, +Y away, +Z up |
"""

import numpy as np

from mocapd.types import Floats

PANDA_FROM_GOAL: Floats = np.array([[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])


def to_panda(points_m: Floats) -> Floats:
    """Points or directions (...,3)."""
    out: Floats = points_m @ PANDA_FROM_GOAL.T
    return out
