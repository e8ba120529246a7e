"""What the network takes for the person is not lost to the room: not as a ghost, nor where clothes have the wall's colour."""

import numpy as np
import pytest

from mocapd.body.model import build_model
from mocapd.body.pose_space import full_body
from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import MotionState, initial_information
from mocapd.fit.solver import Fitter
from mocapd.sim.world import rig_of
from mocapd.tracking.cues.clothes.camera_views import CameraViews
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.tracking.cues.clothes.regions import region_labels
from mocapd.tracking.track_state import BodyShapeEstimate, t_pose_state
from mocapd.types import Bytes
from mocapd.vision.foreground_kernels import BACKGROUND, BEFORE
from mocapd.vision.heatmaps.person_crop import PersonCrop
from tests.sim import small

pytestmark = pytest.mark.kernels
H, W = 240, 320
HERE = np.s_[40:80, 20:60]  # beside the body
CLOTH, WALL = 114, 150


@pytest.fixture
def views_and_body() -> tuple[CameraViews, MotionState]:
    """One camera, and somebody in grey before a wall that is known."""
    table = small.table()
    table["cameras"] = table["cameras"][:1]
    table["cameras"][0] |= {"size_px": [W, H], "dropped": 0.0, "clock_offset_s": 0.0}
    model = build_model(1.75, full_body())
    cameras = rig_of(small.scenario(**table)).cameras
    fitter = Fitter(model, region_labels(model), cameras, [1], FitParams())
    wearer = BodyShapeEstimate(np.ones(model.n_shape), initial_information(model.space), 0.0)
    body = t_pose_state(model, model.rest_m[0].copy(), wearer)
    views = CameraViews(fitter, ClothesParams())
    views.take({0: np.full((H, W, 3), WALL, np.uint8)}, {0: 0.0})
    views.mark_body(None)
    views.seed_background()
    return views, body


def take(views: CameraViews, body: MotionState, picture: Bytes) -> Bytes:
    """The picture, with the drawn body in it; its foreground is found."""
    views.take({0: picture}, {0: 0.0})
    views.mark_body(body)
    picture[views.each[0].drawn > 0] = CLOTH
    views.update_foreground()
    return picture


def look(views: CameraViews) -> None:
    """The network sees a person in HERE alone, and rules one out elsewhere."""
    odds = np.full((96, 96), -3.0, np.float32)
    odds[:, 96 - 96 // 4 :] = 4.0
    rows, columns = HERE
    size_px = columns.stop - columns.start
    scale = (96 // 4) / size_px
    corner_px = np.array([96 - 96 // 4 - columns.start * scale, -rows.start * scale])
    views.each[0].mark_person(odds, PersonCrop(scale, corner_px))


@pytest.mark.parametrize("looked", [False, True])
def test_a_limb_that_the_network_sees_is_no_ghost(
    views_and_body: tuple[CameraViews, MotionState], looked: bool
) -> None:
    """The room has a red door with sharp edges there; a limb in front of it, which nothing drew, has dull ones."""
    views, body = views_and_body
    camera = views.each[0]
    camera.background.mean[HERE] = (20.0, 20.0, 250.0)
    picture = np.full((H, W, 3), WALL, np.uint8)
    picture[HERE] = WALL - 8
    take(views, body, picture)
    assert (camera.foreground[HERE] == BEFORE).mean() > 0.9
    if looked:
        look(views)
    views.remove_ghosts()
    left = BEFORE if looked else BACKGROUND
    assert (camera.foreground[45:75, 25:55] == left).all()


def test_what_the_network_saw_of_somebody_lost_protects_nobody_else(
    views_and_body: tuple[CameraViews, MotionState],
) -> None:
    views, body = views_and_body
    take(views, body, np.full((H, W, 3), WALL, np.uint8))
    look(views)
    assert views.each[0].person_by_network()[HERE].mean() > 0.9
    views.mark_body(None)
    assert not views.each[0].person_by_network().any()


@pytest.mark.parametrize(("looked", "is_new"), [(False, True), (True, False), (True, True)])
def test_a_limb_in_the_colour_of_the_wall_is_seen_where_the_network_sees_it(
    views_and_body: tuple[CameraViews, MotionState], looked: bool, is_new: bool
) -> None:
    """Where it looked at an earlier picture, the limb may have gone."""
    views, body = views_and_body
    camera = views.each[0]
    picture = take(views, body, np.full((H, W, 3), WALL, np.uint8))
    views.learn_first_appearance(body)
    beside = np.argwhere((camera.body > 0) & (camera.drawn == 0))
    y, x = beside[len(beside) // 2]
    camera.background.mean[y, x] = picture[y, x] = CLOTH
    views.take({0: picture}, {0: 0.0})
    views.mark_body(body)
    views.update_foreground()
    if looked:
        camera.mark_person(
            np.full((96, 96), 4.0, np.float32), PersonCrop(96 / W, np.zeros(2)), is_new=is_new
        )
    (view,) = views.classify(body)
    x0, y0, _, _ = view.roi
    assert camera.foreground[y, x] == BACKGROUND
    assert (view.ids[y - y0, x - x0] > 0) == (looked and is_new)
