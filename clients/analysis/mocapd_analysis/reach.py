"""How far a hand gets, in the person's own directions. Pure."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from mocapd.types import Floats
from mocapd_analysis.body_frame import in_body_m
from mocapd_analysis.joint_angles import SIDES, has_trunk
from mocapd_analysis.session import Session


@dataclass(frozen=True, slots=True)
class Reach:
    """Of one wrist [m]. from_shoulder: the farthest from its own shoulder; highest: above the floor; forward, outward,
    across, up: from the middle between the shoulders (across: past the middle, to the other side); volume_l: of the
    space that it went through, as a convex hull [litres]."""

    from_shoulder_m: float
    highest_m: float
    forward_m: float
    outward_m: float
    across_m: float
    up_m: float
    volume_l: float


def reaches_of(session: Session) -> dict[str, Reach]:
    """By side; a side whose wrist is nowhere seen is absent."""
    found: dict[str, Reach] = {}
    if not has_trunk(session):
        return found
    for side, sign in zip(SIDES, (1.0, -1.0), strict=True):
        hand, shoulder = f"{side}Hand", f"{side}UpperArm"
        if not session.has(hand):
            continue
        seen = session.is_seen(hand, shoulder)
        if not seen.any():
            continue
        own = in_body_m(session, (hand,))[seen, 0]
        apart = (session.positions_m(hand) - session.positions_m(shoulder))[seen]
        outward = sign * own[:, 0]
        found[side] = Reach(
            from_shoulder_m=_most(np.linalg.norm(apart, axis=1)),
            highest_m=_most(session.positions_m(hand)[seen, 1]),
            forward_m=_most(own[:, 2]),
            outward_m=_most(outward),
            across_m=_most(-outward),
            up_m=_most(own[:, 1]),
            volume_l=_volume_l(own),
        )
    return found


def _most(values: Floats) -> float:
    """The largest but for the one frame in two hundred that a tracker may have wrong."""
    return float(np.quantile(values, 0.995))


def _volume_l(points_m: Floats) -> float:
    try:
        return 1000.0 * float(ConvexHull(points_m).volume)
    except (QhullError, ValueError):  # too few points, or all in one plane
        return 0.0
