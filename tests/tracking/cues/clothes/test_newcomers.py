"""A camera that was absent when the wearer was found, or does not show them, leaves the body to the others."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.body.model import build_model
from mocapd.body.pose_space import full_body
from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import MotionState, initial_information
from mocapd.fit.solver import Fitter
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import centre
from mocapd.sim.world import rig_of
from mocapd.tracking.cues.clothes.camera_views import CameraViews
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.tracking.cues.clothes.region_merge import NO_MERGE
from mocapd.tracking.cues.clothes.regions import region_labels
from mocapd.tracking.track_state import BodyShapeEstimate, t_pose_state
from mocapd.types import Camera
from tests.sim import small

pytestmark = pytest.mark.kernels
GREY = np.full((240, 320, 3), 114, np.uint8)
BOTH = {0: 0.0, 1: 0.0}


def turned_away(camera: Camera) -> Camera:
    """On the same spot."""
    R = rotations.to_matrix(rotations.exp(np.array([0.0, 2.0, 0.0]))) @ camera.R
    return replace(camera, R=R, t_m=-R @ centre(camera))


def views_and_body(sees: bool) -> tuple[CameraViews, MotionState]:
    table = small.table()
    for camera in table["cameras"]:
        camera |= {"size_px": [320, 240], "dropped": 0.0, "clock_offset_s": 0.0}
    first, second = rig_of(small.scenario(**table)).cameras
    body = build_model(1.75, full_body())
    cameras = [first, second if sees else turned_away(second)]
    fitter = Fitter(body, region_labels(body), cameras, [1, 1], FitParams())
    wearer = BodyShapeEstimate(np.ones(body.n_shape), initial_information(body.space), 0.0)
    return CameraViews(fitter, ClothesParams()), t_pose_state(body, body.rest_m[0].copy(), wearer)


def learn_body(views: CameraViews, body: MotionState, present: dict[int, float]) -> None:
    views.take(dict.fromkeys(present, GREY), present)
    views.mark_body(body)
    views.seed_background()
    views.update_foreground()
    views.learn_first_appearance(body)


def test_a_camera_that_comes_later_is_left_out_until_it_is_taught() -> None:
    views, body = views_and_body(sees=True)
    learn_body(views, body, {0: 0.0})
    views.take(dict.fromkeys(BOTH, GREY), BOTH)
    assert views.are_new
    views.set_newcomers_aside()
    assert (views.present, views.newcomers) == ({0: 0.0}, {1: 0.0})
    assert [view.index for view in views.classify(body)] == [0]
    views.admit_newcomers(body, NO_MERGE)
    assert (views.present, views.newcomers) == (BOTH, {})
    views.set_newcomers_aside()
    assert views.present == BOTH
    assert [view.index for view in views.classify(body)] == [0, 1]


def test_a_camera_that_does_not_show_the_person_stays_aside() -> None:
    views, body = views_and_body(sees=False)
    learn_body(views, body, BOTH)
    for _ in range(2):
        views.take(dict.fromkeys(BOTH, GREY), BOTH)
        views.set_newcomers_aside()
        assert views.present == {0: 0.0}
        views.admit_newcomers(body, NO_MERGE)


def test_a_camera_that_comes_later_leaves_the_backgrounds_of_the_others_as_they_are() -> None:
    views, body = views_and_body(sees=True)
    learn_body(views, body, {0: 0.0})
    passer_by = GREY.copy()
    passer_by[60:200, :60] = 20
    views.take({0: passer_by, 1: GREY}, BOTH)
    views.mark_body(body)
    views.seed_background()
    assert not views.are_new
    assert views.each[0].background.mean[100, 30].tolist() == [114.0] * 3


def test_where_no_camera_knows_the_person_none_is_left_out() -> None:
    views, _ = views_and_body(sees=True)
    views.take(dict.fromkeys(BOTH, GREY), BOTH)
    views.set_newcomers_aside()
    assert (views.present, views.newcomers) == (BOTH, {})
