"""How unusual a pose of a leg is."""

from dataclasses import replace

import numpy as np

from mocapd.body.skeleton import INDEX
from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import initial_information
from mocapd.fit.priors.pose_prior import unusual_leg, usual_leg
from mocapd.fit.solver import Fitter
from mocapd.fit.view import View
from mocapd.geometry import rotations
from mocapd.tracking.cues.clothes.regions import silhouette_labels
from mocapd.tracking.track_state import BodyShapeEstimate, t_pose_state
from mocapd.types import Floats
from tests.fit.term_system import BODY
from tests.geometry.rigs import looking_at

CAMERAS = tuple(
    looking_at(name, np.array(eye_m), np.array([0.0, 1.1, 0.0]), roll_rad=0.0)
    for name, eye_m in (("front", (0.0, 1.3, 3.0)), ("side", (3.0, 1.3, 0.0)))
)


def bent(side: str, thigh_rad: Floats, shank_rad: Floats) -> float:
    pose = usual_leg(side)
    pose[0], pose[1] = rotations.exp(thigh_rad), rotations.exp(shank_rad)
    return float(unusual_leg(pose[None], side)[0])


def test_knees_that_bend_forwards_are_more_unusual_than_those_that_bend_back() -> None:
    none = np.zeros(3)
    back, forwards = (bent("left", none, np.array([way, 0.0, 0.0])) for way in (0.8, -0.8))
    assert back < forwards


def test_both_legs_count_alike() -> None:
    thigh = np.array([-0.9, 0.2, 0.3])
    mirrored = thigh * np.array([1.0, -1.0, -1.0])
    assert np.isclose(bent("left", thigh, np.zeros(3)), bent("right", mirrored, np.zeros(3)))


def settled_leg(near_m: float) -> Floats:
    """Local rotations (2,4) of thigh and shank of a leg that was lifted, two seconds later, of somebody near to the first of
    two cameras, which tell nothing."""
    by = Fitter(BODY, silhouette_labels(BODY), CAMERAS, [2, 2], FitParams())
    wearer = BodyShapeEstimate(np.ones(BODY.n_shape), initial_information(BODY.space), 0.0)
    body = t_pose_state(BODY, BODY.rest_m[0] + (0.0, 0.0, near_m), wearer)
    local = body.local_xyzw.copy()
    local[INDEX["leftUpperLeg"]] = rotations.exp(np.array([-1.6, 0.0, 0.6]))
    body, nothing = replace(body, local_xyzw=local), np.zeros((120, 160), np.uint8)
    views = [View(i, (80, 60, 240, 180), nothing, nothing, 0.0) for i in range(2)]
    assert not by.has_small_baseline(body, views)
    assert by.show_feet(body, views) == (near_m == 0.0)
    for _ in range(60):
        body = by.fit(body, views, 1 / 30, 1).state
    return body.local_xyzw[[INDEX["left" + bone] for bone in ("UpperLeg", "LowerLeg")]]


def test_a_leg_out_of_the_pictures_goes_back_to_where_it_usually_is() -> None:
    hidden_rad, shown_rad = (
        rotations.angle_rad(settled_leg(near_m), usual_leg("left")[:2]).max()
        for near_m in (2.2, 0.0)
    )
    assert hidden_rad < 0.02
    assert shown_rad > 0.2
