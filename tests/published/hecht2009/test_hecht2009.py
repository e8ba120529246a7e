"""The published tracker as its users notice it: it starts by itself, follows, and goes when they go."""

import numpy as np
import pytest

from mocapd.body.shape import mean_shape
from mocapd.published.hecht2009.mass_spring.body_points import LIMBS
from mocapd.published.hecht2009.mass_spring.mass_spring_body import build_body
from mocapd.published.hecht2009.mass_spring.simulation import relaxed_state
from mocapd.published.hecht2009.part_confidence import joint_confidence, joint_uncertainty_m
from mocapd.published.hecht2009.stances import stances_of
from mocapd.tracking.base import Track
from mocapd.tracking.tracker_inputs import wearer_shape
from mocapd.types import FrameSet, Tracking
from tests.tracking.plain_film import N_EMPTY, PlainFilm, plain_film
from tests.tracking.profiles import hecht2009_tracker
from tests.tracking.stepping import Stepping

pytestmark = pytest.mark.kernels


@pytest.fixture(scope="module")
def film() -> PlainFilm:
    return plain_film()


@pytest.fixture(scope="module")
def tracker(film: PlainFilm) -> Stepping:
    return Stepping(hecht2009_tracker(film.known), wearer_shape(film.known))


def run(tracker: Stepping, frames: list[FrameSet]) -> list[Track]:
    return [tracker.step(one) for one in frames]


def test_somebody_who_comes_is_followed_and_lost_when_gone(
    film: PlainFilm, tracker: Stepping
) -> None:
    tracker.reset()
    tracks = run(tracker, film.frames)
    assert all(t.body.tracking is Tracking.LOST for t in tracks[:N_EMPTY])
    live = [i for i, t in enumerate(tracks) if t.body.tracking is Tracking.LIVE]
    assert live
    assert live[0] - N_EMPTY < 20
    away = []
    for i in live:
        joints, truth = tracks[i].body.joints_m, film.joints_m[i - N_EMPTY]
        assert joints is not None
        assert truth is not None
        away.append(np.linalg.norm(joints - truth, axis=1))
    assert np.median(away) < 0.15
    assert run(tracker, film.empty)[-1].body.tracking is Tracking.LOST


def test_raised_arms_are_as_long_as_the_bodys_and_reach_outwards() -> None:
    body = build_body(mean_shape(1.75))
    points = relaxed_state(body, np.array([0.0, 1.64, 0.0])).points_m
    stances = stances_of(body, points, (0.5 * np.pi,))
    for limb, outwards in (("left_arm", 1.0), ("right_arm", -1.0)):
        raised, rest = stances[limb][-1], body.rest_m[list(LIMBS[limb])]
        assert np.allclose(
            np.linalg.norm(np.diff(raised, axis=0), axis=1),
            np.linalg.norm(np.diff(rest, axis=0), axis=1),
        )
        assert outwards * (raised[2, 0] - raised[0, 0]) > 0.4
        assert abs(raised[2, 1] - raised[0, 1]) < 0.05
    assert len(stances["left_leg"]) == 1


def test_what_is_spread_is_less_sure_and_less_believed() -> None:
    near = joint_uncertainty_m(np.full(16, 0.02), 0.02)
    far = joint_uncertainty_m(np.full(16, 0.2), 0.02)
    assert (far >= near).all()
    seen = np.ones(11)
    assert (joint_confidence(seen, far) <= joint_confidence(seen, near)).all()
    assert not joint_confidence(np.zeros(11), near).any()
