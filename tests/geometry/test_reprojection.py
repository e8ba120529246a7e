"""Reprojection row by row: the camera model's pixels, and Jacobians that are its differences."""

import numpy as np

from mocapd.geometry.camera_model import (
    distort,
    distortion_by_coefficients,
    distortion_by_point,
    perspective_jacobians,
    project,
    to_camera,
)
from mocapd.geometry.reprojection import (
    INTRINSICS,
    camera_matrix,
    intrinsics_row,
    project_rows,
    projection_jacobians,
)
from mocapd.types import Floats
from tests.geometry.rigs import WEBCAM_DIST, points_in_the_play_area, ring

H = 1e-6
CAMERAS = ring(3)


def rows(n: int = 30) -> tuple[Floats, Floats, Floats]:
    """Intrinsics (n,9), points (n,3) in their cameras' frames, and the pixels (n,2) of `project`."""
    world_m = points_in_the_play_area(n)
    cameras = [CAMERAS[i % 3] for i in range(n)]
    intrinsics = np.stack([intrinsics_row(c.K, c.dist * (1 + i)) for i, c in enumerate(CAMERAS)])
    rig = [
        type(c)(c.name, c.size_px, c.K, c.dist * (1 + i), c.R, c.t_m) for i, c in enumerate(CAMERAS)
    ]
    points = np.stack([to_camera(c, x) for c, x in zip(cameras, world_m, strict=True)])
    pixels = np.stack([project(rig[i % 3], world_m[i]) for i in range(n)])
    return intrinsics[np.arange(n) % 3], points, pixels


def test_rows_are_projected_as_by_their_own_cameras() -> None:
    intrinsics, points_m, pixels = rows()
    np.testing.assert_allclose(project_rows(intrinsics, points_m), pixels, atol=1e-9)


def test_a_row_holds_the_camera_matrix() -> None:
    row = intrinsics_row(CAMERAS[0].K, CAMERAS[0].dist)
    np.testing.assert_array_equal(camera_matrix(row), CAMERAS[0].K)
    np.testing.assert_array_equal(row[4:], CAMERAS[0].dist)


def test_jacobians_are_differences_of_the_pixels() -> None:
    intrinsics, points_m, _ = rows()
    by_intrinsics, by_point = projection_jacobians(intrinsics, points_m)
    for k, step in enumerate(H * np.eye(INTRINSICS)):
        ahead, behind = (project_rows(intrinsics + s * step, points_m) for s in (1.0, -1.0))
        np.testing.assert_allclose((ahead - behind) / (2 * H), by_intrinsics[..., k], atol=1e-5)
    for k, step in enumerate(H * np.eye(3)):
        ahead, behind = (project_rows(intrinsics, points_m + s * step) for s in (1.0, -1.0))
        np.testing.assert_allclose((ahead - behind) / (2 * H), by_point[..., k], atol=1e-5)


def test_what_is_behind_a_camera_has_a_finite_residual() -> None:
    intrinsics, points_m, _ = rows(3)
    behind_m = points_m * [1.0, 1.0, -1.0]
    assert np.isfinite(project_rows(intrinsics, behind_m)).all()


def test_distortion_derivatives_are_differences() -> None:
    xy = np.random.default_rng(0).uniform(-0.5, 0.5, (4, 5, 2))
    by_point = distortion_by_point(WEBCAM_DIST, xy)
    for k, step in enumerate(H * np.eye(2)):
        slope = (distort(WEBCAM_DIST, xy + step) - distort(WEBCAM_DIST, xy - step)) / (2 * H)
        np.testing.assert_allclose(slope, by_point[..., k], atol=1e-8)
    by_coefficient = distortion_by_coefficients(xy)
    np.testing.assert_allclose(distort(WEBCAM_DIST, xy), xy + by_coefficient @ WEBCAM_DIST)


def test_perspective_derivatives_are_differences() -> None:
    points_m = np.random.default_rng(1).uniform([-1, -1, 0.5], [1, 1, 3], (6, 3))

    def normalised(p: Floats) -> Floats:
        xy: Floats = p[:, :2] / p[:, 2:]
        return xy

    by_point = perspective_jacobians(normalised(points_m), points_m[:, 2])
    for k, step in enumerate(H * np.eye(3)):
        slope = (normalised(points_m + step) - normalised(points_m - step)) / (2 * H)
        np.testing.assert_allclose(slope, by_point[..., k], atol=1e-7)
