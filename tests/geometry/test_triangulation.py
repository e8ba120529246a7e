"""Points from rays: exact where the rays are, optimal where they are not, NaN where nothing is known."""

import numpy as np
import pytest
import scipy  # its submodules load on first use: they take long to import

from mocapd.geometry import camera_model
from mocapd.geometry.triangulation import triangulate
from mocapd.types import Camera, Floats
from tests.geometry.rigs import looking_at, points_in_the_play_area, ring


def seen_by(rig: tuple[Camera, ...], world_m: Floats, noise_px: float = 0.0) -> Floats:
    rng = np.random.default_rng(8)
    return np.stack(
        [
            camera_model.normalised(
                c,
                camera_model.project(c, world_m)
                + noise_px * rng.standard_normal((*world_m.shape[:-1], 2)),
            )
            for c in rig
        ]
    )


@pytest.mark.parametrize("n", [2, 3, 5])
def test_exact_rays_meet_in_the_point(n: int) -> None:
    rig, world_m = ring(n), points_in_the_play_area(50)
    points_m, residuals_m = triangulate(rig, seen_by(rig, world_m))
    assert points_m.shape == (50, 3)
    assert residuals_m.shape == (n, 50)
    assert np.abs(points_m - world_m).max() < 1e-5  # what undistortion leaves
    assert residuals_m.max() < 1e-5


def test_with_noise_it_is_as_good_as_the_least_reprojection_error() -> None:
    rig, world_m = ring(4), points_in_the_play_area(30)
    xy = seen_by(rig, world_m, noise_px=2.0)
    points_m, residuals_m = triangulate(rig, xy)

    def optimum(k: int) -> Floats:
        def error(x_m: Floats) -> Floats:
            p = np.stack([camera_model.to_camera(c, x_m) for c in rig])
            return np.asarray((p[:, :2] / p[:, 2:] - xy[:, k]).ravel())

        return np.asarray(scipy.optimize.least_squares(error, world_m[k], xtol=1e-14, ftol=1e-14).x)

    best_m = np.array([optimum(k) for k in range(30)])
    assert np.abs(points_m - best_m).max() < 2e-4
    assert np.sqrt(np.mean((points_m - world_m) ** 2)) < 0.01
    assert 0.001 < np.median(residuals_m) < 0.03


def test_residuals_are_distances_from_the_rays() -> None:
    rig = ring(3)
    xy = seen_by(rig, points_in_the_play_area(5), noise_px=5.0)
    points_m, residuals_m = triangulate(rig, xy)
    for i, camera in enumerate(rig):
        pixels = (
            camera_model.distort(camera.dist, xy[i]) * camera.K[[0, 1], [0, 1]] + camera.K[:2, 2]
        )
        centre_m, directions = camera_model.rays(camera, pixels)
        expected = np.linalg.norm(np.cross(points_m - centre_m, directions), axis=-1)
        assert np.allclose(residuals_m[i], expected, atol=1e-6)


def test_weights_decide_between_rays_that_disagree() -> None:
    rig, world_m = ring(3), points_in_the_play_area(10)
    xy = seen_by(rig, world_m)
    xy[2] += 0.05
    equal_m, _ = triangulate(rig, xy)
    weights = np.ones((3, 10))
    weights[2] = 1e-6
    points_m, residuals_m = triangulate(rig, xy, weights)
    assert np.abs(points_m - world_m).max() < 1e-3
    assert np.abs(equal_m - world_m).max() > 0.01
    assert residuals_m[2].min() > 0.05
    scaled_m, _ = triangulate(rig, xy, 1e4 * weights)
    assert np.allclose(points_m, scaled_m)


def test_a_camera_that_does_not_see_the_point_does_not_count() -> None:
    rig, world_m = ring(3), points_in_the_play_area(4)
    xy = seen_by(rig, world_m)
    xy[0, 0] = np.nan
    weights = np.ones((3, 4))
    weights[1, 1] = 0.0
    weights[2, 2] = np.nan
    xy[:2, 3] = np.nan  # one ray only
    points_m, residuals_m = triangulate(rig, xy, weights)
    assert np.abs(points_m[:3] - world_m[:3]).max() < 1e-5
    assert np.isnan(points_m[3]).all()
    unseen = np.zeros((3, 4), bool)
    unseen[0, 0] = unseen[1, 1] = unseen[2, 2] = True
    assert np.isnan(residuals_m[:, :3][unseen[:, :3]]).all()
    assert np.isfinite(residuals_m[:, :3][~unseen[:, :3]]).all()
    assert np.isnan(residuals_m[:, 3]).all()


def test_parallel_rays_meet_nowhere() -> None:
    left = looking_at("l", np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0, 0.0]), np.zeros(5), 0.0)
    right = Camera("r", left.size_px, left.K, left.dist, left.R, left.t_m - np.array([0.1, 0, 0]))
    points_m, _ = triangulate((left, right), np.zeros((2, 1, 2)))
    assert np.isnan(points_m).all()
    one_m, one_residual = triangulate((left,), np.zeros((1, 1, 2)))
    assert np.isnan(one_m).all()
    assert np.isnan(one_residual).all()


@pytest.mark.parametrize("batch", [(), (1,), (3, 1, 2)])
def test_batches_are_their_elements(batch: tuple[int, ...]) -> None:
    rig = ring(3)
    world_m = points_in_the_play_area(6)[: int(np.prod(batch))].reshape(*batch, 3)
    xy = seen_by(rig, world_m, noise_px=1.0)
    points_m, residuals_m = triangulate(rig, xy)
    assert points_m.shape == (*batch, 3)
    assert residuals_m.shape == (3, *batch)
    for i in np.ndindex(batch):
        one_m, one_residual = triangulate(rig, xy[(slice(None), *i)])
        assert np.allclose(points_m[i], one_m)
        assert np.allclose(residuals_m[(slice(None), *i)], one_residual)
