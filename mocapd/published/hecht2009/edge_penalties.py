"""How well the edges of all pictures agree with limbs in given places."""

from collections.abc import Sequence

import numpy as np

from mocapd.published.hecht2009.cylinders.limb_params import LimbScoreParams
from mocapd.published.hecht2009.cylinders.limb_score import EDGE, LimbView, limb_penalties
from mocapd.published.hecht2009.mass_spring.body_points import LIMBS
from mocapd.published.hecht2009.mass_spring.frusta import NAMES, Frusta
from mocapd.types import Floats

# The upper and the lower frustum of each limb.
PARTS = {
    limb: (NAMES.index(f"{limb[:-3]}{upper}"), NAMES.index(f"{limb[:-3]}{lower}"))
    for limb, (upper, lower) in {
        "left_arm": ("upper_arm", "forearm"), "right_arm": ("upper_arm", "forearm"),
        "left_leg": ("thigh", "shank"), "right_leg": ("thigh", "shank"),
    }.items()
}  # fmt: skip


def edge_penalties(
    frusta: Frusta, limb: str, points_m: Floats, views: Sequence[LimbView], score: LimbScoreParams
) -> Floats:
    """The edge penalty (N,) 0..1 of the visible part of a limb in N places (N,3,3); 1 where nothing is visible."""
    parts = PARTS[limb]
    penalties = limb_penalties(points_m, frusta.radii_m[list(parts)], parts, views, score)
    visible = penalties.visible[..., EDGE].sum(axis=0)
    total = (penalties.visible[..., EDGE] * penalties.mean[..., EDGE]).sum(axis=0)
    return np.where(visible > 0.0, total / np.maximum(visible, 1e-9), 1.0)


def mean_edge_penalty(
    frusta: Frusta, points_m: Floats, views: Sequence[LimbView], score: LimbScoreParams
) -> float:
    """The mean edge penalty 0..1 of the limbs of a body of points (16,3)."""
    each = [
        edge_penalties(frusta, limb, points_m[list(which)][None], views, score)[0]
        for limb, which in LIMBS.items()
    ]
    return float(np.mean(each))
