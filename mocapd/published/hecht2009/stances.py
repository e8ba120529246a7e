"""Initial limb poses: hanging, arms also raised sideways."""

from collections.abc import Sequence

import numpy as np

from mocapd.geometry import rotations
from mocapd.published.hecht2009.mass_spring.body_points import LIMBS, SHOULDER, head_forward
from mocapd.published.hecht2009.mass_spring.mass_spring_body import MassSpringBody
from mocapd.types import Floats


def stances_of(
    body: MassSpringBody, points_m: Floats, raised_rad: Sequence[float]
) -> dict[str, Floats]:
    """Places (N,3,3) [m] of each of LIMBS of a body that hangs at points_m (16,3): N = 1 for legs; straight arms raised
    sideways by each of the angles."""
    forward = head_forward(points_m)
    out = {}
    for limb, which in LIMBS.items():
        hung = points_m[list(which)]
        if limb.endswith("leg"):
            out[limb] = hung[None]
            continue
        rest = body.rest_m[list(which)]
        reach = np.concatenate([[0.0], np.linalg.norm(np.diff(rest, axis=0), axis=1)]).cumsum()
        outwards = 1.0 if which[0] == SHOULDER[0] else -1.0
        arms = [hung]
        for angle in raised_rad:
            turn = rotations.exp(outwards * angle * forward)
            down = rotations.rotate(turn, np.array([0.0, -1.0, 0.0]))
            arms.append(hung[0] + reach[:, None] * down)
        out[limb] = np.array(arms)
    return out
