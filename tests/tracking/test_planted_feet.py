"""Feet are planted when they have been in one place on the floor for a while, and lifted when they step or rise."""

import numpy as np
import pytest

from mocapd.body.model import build_model
from mocapd.body.pose_space import full_body
from mocapd.body.skeleton import INDEX
from mocapd.clock import nanoseconds
from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import initial_information
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.floor_term import PlantedTerm
from mocapd.geometry.nominal_rig import nominal_rig
from mocapd.tracking.cues.clothes.regions import silhouette_labels
from mocapd.tracking.planted_feet import PlantedFeet, PlantedFeetParams
from mocapd.tracking.track_state import BodyShapeEstimate, t_pose_state
from mocapd.types import Floats

pytestmark = pytest.mark.kernels

BODY = build_model(1.75, full_body())
LEFT = [INDEX["leftFoot"], INDEX["leftToes"]]
RIGHT = [INDEX["rightFoot"], INDEX["rightToes"]]
RATES = pytest.mark.parametrize("hz", [15.0, 30.0, 60.0])


def moved(bones: list[int], by_m: tuple[float, float, float]) -> Floats:
    out = BODY.rest_m.copy()
    out[bones] += by_m
    return out


def feet_after(poses_m: list[tuple[float, Floats]], hz: float) -> PlantedFeet:
    """Each pose lasts until the time that is given with it [s]."""
    feet, frame = PlantedFeet(BODY.rest_m, PlantedFeetParams()), 0
    for until_s, joints_m in poses_m:
        while frame / hz < until_s:
            feet.update(joints_m, nanoseconds(frame / hz))
            frame += 1
    return feet


@RATES
def test_feet_that_stay_are_planted_where_they_are(hz: float) -> None:
    assert len(feet_after([(0.2, BODY.rest_m)], hz).joints) == 0
    feet = feet_after([(0.6, BODY.rest_m)], hz)
    assert sorted(feet.joints) == sorted(LEFT + RIGHT)
    assert feet.places_m == pytest.approx(BODY.rest_m[feet.joints][:, [0, 2]])


def test_feet_of_a_body_that_was_lost_are_not_planted_for_the_next() -> None:
    feet = feet_after([(0.6, BODY.rest_m)], 30.0)
    feet.expire(nanoseconds(1.2))
    assert len(feet.joints) == 4
    feet.expire(nanoseconds(10.0))
    assert len(feet.joints) == 0
    feet.update(BODY.rest_m, nanoseconds(10.0))
    assert len(feet.joints) == 0


@RATES
@pytest.mark.parametrize("step_m", [(0.2, 0.0, 0.0), (0.0, 0.15, 0.0)])
def test_a_foot_that_steps_or_rises_is_free_at_once(
    hz: float, step_m: tuple[float, float, float]
) -> None:
    feet = feet_after([(0.6, BODY.rest_m), (0.61 + 1.0 / hz, moved(LEFT, step_m))], hz)
    assert sorted(feet.joints) == sorted(RIGHT)


def test_a_foot_off_the_floor_is_never_planted() -> None:
    assert sorted(feet_after([(2.0, moved(LEFT, (0.0, 0.1, 0.0)))], 30.0).joints) == sorted(RIGHT)


@RATES
def test_what_trembles_about_a_place_is_held_near_its_mean(hz: float) -> None:
    rng, feet = np.random.default_rng(1), PlantedFeet(BODY.rest_m, PlantedFeetParams())
    for frame in range(round(3.0 * hz)):
        off_m = rng.normal(0.0, 0.005, (2, 3)) * (1.0, 0.0, 1.0)
        joints_m = BODY.rest_m.copy()
        joints_m[LEFT] += off_m
        feet.update(joints_m, nanoseconds(frame / hz))
    places_m = feet.places_m[np.isin(feet.joints, LEFT)]
    assert np.abs(places_m - BODY.rest_m[LEFT][:, [0, 2]]).max() < 0.003


def test_a_planted_foot_holds_the_leg_but_not_against_what_is_far_away() -> None:
    rig = nominal_rig("camera", (320, 240))
    fitter = Fitter(BODY, silhouette_labels(BODY), rig.cameras, [1], FitParams())
    wearer = BodyShapeEstimate(np.ones(BODY.n_shape), initial_information(BODY.space), 0.0)
    body = t_pose_state(BODY, BODY.rest_m[0].copy(), wearer)
    ankle = LEFT[0]

    def off_after_m(away_m: float) -> float:
        place_m = BODY.rest_m[[ankle]][:, [0, 2]] + (0.0, away_m)
        term = PlantedTerm(BODY, np.array([ankle]), place_m, np.ones(1))
        joints_m, _ = fitter.joints(fitter.fit(body, (), 1 / 30, 4, terms=(term,)).state)
        return float(np.linalg.norm(joints_m[ankle][[0, 2]] - place_m))

    assert off_after_m(0.01) < 0.002
    assert off_after_m(0.5) > 0.4


@RATES
def test_before_cameras_from_one_side_a_foot_that_stands_may_wander_along_their_line_of_sight(
    hz: float,
) -> None:
    sight = np.array([0.0, -0.5, -1.0])
    along, across = (
        wandering_feet(axis, hz, sight) for axis in (np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0]))
    )  # fmt: skip
    assert sorted(along.joints) == sorted(LEFT + RIGHT)
    assert along.places_m == pytest.approx(BODY.rest_m[along.joints][:, [0, 2]], abs=0.02)
    assert len(across.joints) == 0


def wandering_feet(axis: Floats, hz: float, sight: Floats) -> PlantedFeet:
    """Feet of somebody who stands for 3 s, found up to 5 cm away along an axis."""
    feet = PlantedFeet(BODY.rest_m, PlantedFeetParams())
    for frame in range(round(3.0 * hz)):
        off_m = 0.05 * np.sin(9.0 * frame / hz) * axis
        feet.update(BODY.rest_m + off_m, nanoseconds(frame / hz), sight)
    return feet


@RATES
def test_a_foot_is_held_the_more_firmly_the_longer_it_has_stood(hz: float) -> None:
    early, late, later = (
        feet_after([(for_s, BODY.rest_m)], hz).firmness for for_s in (0.6, 3.0, 8.0)
    )
    assert (early < 0.2).all()
    assert (early < late).all()
    assert (late < later).all()
    assert later == pytest.approx(1.0)


@RATES
def test_a_foot_that_was_found_elsewhere_at_first_is_soon_where_it_stands(hz: float) -> None:
    first = moved(LEFT, (0.02, 0.0, 0.0))
    feet = feet_after([(0.6, first), (2.4, BODY.rest_m)], hz)
    assert feet.places_m[np.isin(feet.joints, LEFT), 0] == pytest.approx(
        BODY.rest_m[LEFT, 0], abs=0.006
    )
