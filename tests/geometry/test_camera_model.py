"""Projection against OpenCV's, there and back, and by differences."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocapd.geometry import camera_model, rotations
from mocapd.types import Camera, Floats
from tests.geometry.rigs import WEBCAM_DIST, looking_at, points_in_the_play_area, ring

EYE_M, TARGET_M = np.array([0.7, 1.4, 2.6]), np.array([0.0, 1.0, 0.0])
LENSES = {
    "none": np.zeros(5),
    "webcam": WEBCAM_DIST,
    "barrel": np.array([-0.3, 0.11, 0.001, -0.0007, -0.02]),
    "tangential": np.array([0.0, 0.0, 0.004, -0.006, 0.0]),
}


def opencv_project(camera: Camera, world_m: Floats) -> tuple[Floats, Floats]:
    rvec = rotations.log(rotations.from_matrix(camera.R))
    pixels, jacobian = cv2.projectPoints(world_m, rvec, camera.t_m, camera.K, camera.dist)
    return np.asarray(pixels[:, 0], float), np.asarray(jacobian, float)


@pytest.mark.parametrize("lens", list(LENSES))
def test_projects_as_opencv_does(lens: str) -> None:
    camera = looking_at("a", EYE_M, TARGET_M, LENSES[lens])
    world_m = points_in_the_play_area(200)
    expected, _ = opencv_project(camera, world_m)
    assert np.abs(camera_model.project(camera, world_m) - expected).max() < 1e-8


@pytest.mark.parametrize("lens", list(LENSES))
def test_its_differences_are_opencvs_jacobian(lens: str) -> None:
    camera = looking_at("a", EYE_M, TARGET_M, LENSES[lens])
    world_m = points_in_the_play_area(20)
    _, jacobian = opencv_project(camera, world_m)
    by_t = jacobian[:, 3:6].reshape(-1, 2, 3)  # moving the camera's frame moves all points
    h = 1e-6
    for axis in range(3):
        step = camera.R.T @ np.eye(3)[axis] * h
        ahead, behind = (camera_model.project(camera, world_m + s * step) for s in (1.0, -1.0))
        assert np.allclose((ahead - behind) / (2 * h), by_t[:, :, axis], rtol=1e-5, atol=1e-4)


@pytest.mark.parametrize("lens", list(LENSES))
def test_every_pixel_comes_back_along_its_ray(lens: str) -> None:
    camera = looking_at("a", EYE_M, TARGET_M, LENSES[lens])
    x, y = np.meshgrid(np.arange(0.0, 640.0, 13.0), np.arange(0.0, 480.0, 13.0))
    pixels = np.stack([x, y], axis=-1)
    centre_m, directions = camera_model.rays(camera, pixels)
    assert np.allclose(centre_m, EYE_M)
    assert np.allclose(np.linalg.norm(directions, axis=-1), 1.0)
    for depth_m in (0.5, 3.0):
        again = camera_model.project(camera, centre_m + depth_m * directions)
        assert np.abs(again - pixels).max() < 1e-3


def test_undistorts_as_opencv_does() -> None:
    camera = looking_at("a", EYE_M, TARGET_M)
    pixels = np.random.default_rng(1).uniform([0, 0], [640, 480], (100, 2))
    criteria = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 100, 1e-12)
    expected = cv2.undistortPoints(pixels[:, None], camera.K, camera.dist, criteria=criteria)[:, 0]
    assert np.abs(camera_model.normalised(camera, pixels) - expected).max() < 1e-6


def test_a_picture_is_undistorted_as_its_rows_are() -> None:
    """In blocks, whose borders show nowhere."""
    x, y = np.meshgrid(np.linspace(-0.6, 0.6, 300), np.linspace(-0.4, 0.4, 111))
    xy, dist = np.stack([x, y], axis=-1), np.array([-0.28, 0.07, 0.001, -0.0005, 0.01])
    rows = [camera_model.undistort(dist, row) for row in xy]
    assert np.array_equal(camera_model.undistort(dist, xy), rows)


@given(st.floats(-0.35, 0.2), st.floats(-0.1, 0.1), st.floats(-0.004, 0.004))
def test_undistort_undoes_distort_for_the_lenses_of_webcams(k1: float, k2: float, p: float) -> None:
    dist = np.array([k1, k2, p, -p, 0.01])
    xy = np.stack(np.meshgrid(np.linspace(-0.52, 0.52, 9), np.linspace(-0.4, 0.4, 7)), axis=-1)
    assert np.abs(camera_model.undistort(dist, camera_model.distort(dist, xy)) - xy).max() < 1e-5


def test_the_middle_of_the_picture_is_what_it_looks_at_and_down_is_down() -> None:
    camera = looking_at("a", EYE_M, TARGET_M, roll_rad=0.0)
    assert np.allclose(camera_model.project(camera, TARGET_M), camera.K[:2, 2])
    above = camera_model.project(camera, TARGET_M + np.array([0.0, 0.1, 0.0]))
    assert above[1] < camera.K[1, 2] - 10.0
    # seen from the front, a person who faces +Z has the left side (+X) on the right of the picture
    front = looking_at("b", np.array([0.0, 1.0, 3.0]), TARGET_M, roll_rad=0.0)
    assert (
        camera_model.project(front, TARGET_M + np.array([0.1, 0.0, 0.0]))[0] > front.K[0, 2] + 10.0
    )


def test_behind_the_camera_there_is_no_pixel() -> None:
    camera = looking_at("a", EYE_M, TARGET_M)
    behind_m = EYE_M + (EYE_M - TARGET_M)
    assert np.isnan(camera_model.project(camera, np.stack([behind_m, EYE_M]))).all()


@pytest.mark.parametrize("batch", [(), (1,), (3, 1, 2)])
def test_batches_are_their_elements(batch: tuple[int, ...]) -> None:
    camera = ring(3)[1]
    world_m = points_in_the_play_area(6)[: int(np.prod(batch))].reshape(*batch, 3)
    pixels = camera_model.project(camera, world_m)
    assert pixels.shape == (*batch, 2)
    for i in np.ndindex(batch):
        assert np.allclose(pixels[i], camera_model.project(camera, world_m[i]))
