"""Points on rays of one camera in the picture of another one: as the camera model has them."""

import numpy as np
import pytest

from mocapd.body.arrays import camera_arrays
from mocapd.body.model import Shaper, build_model
from mocapd.body.pose_space import full_body
from mocapd.fit.rays_in_other_kernels import (
    distances_of_triangles,
    evenly_between,
    shown_on_rays,
)
from mocapd.fit.work_rays import rays_at, work_rays_in_world
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import centre, project, rays
from tests.geometry.rigs import looking_at

pytestmark = pytest.mark.kernels

TARGET = np.array([0.0, 1.0, 0.0])
LEFT, RIGHT = (
    looking_at(name, np.array([x, 1.2, 2.8]), TARGET + [x, 0.0, 0.0]) for name, x in (("left", -0.06), ("right", 0.06))
)  # fmt: skip


def test_points_on_rays_show_where_the_camera_model_has_them() -> None:
    rng = np.random.default_rng(0)
    origin, along = rays(LEFT, rng.uniform(0, 480, (40, 2)))
    distances = rng.uniform(-1.0, 5.0, (40, 7))
    out = np.empty((40, 7, 2))
    shown_on_rays(camera_arrays(RIGHT), origin, along, distances, out)
    wanted = project(RIGHT, origin + distances[..., None] * along[:, None])
    np.testing.assert_allclose(out, wanted, atol=1e-9)
    assert np.isnan(out).any()  # what is behind the camera shows nowhere
    assert np.isfinite(out).any()


def test_places_lead_from_one_end_to_the_other() -> None:
    rng = np.random.default_rng(1)
    one, other = rng.uniform(0, 640, (2, 9, 2))
    out = np.empty((9, 5, 2))
    evenly_between(one, other, out)
    np.testing.assert_allclose(out, np.linspace(one, other, 5, axis=1), atol=1e-9)


def test_rays_of_work_pixels_are_those_of_their_middles() -> None:
    y, x = np.array([0, 17, 239]), np.array([319, 40, 0])
    pixels, along = rays_at(work_rays_in_world(LEFT, 2), y, x, 2)
    np.testing.assert_array_equal(pixels, np.stack([2.0 * x + 0.5, 2.0 * y + 0.5], axis=1))
    np.testing.assert_allclose(along, rays(LEFT, pixels)[1], atol=1e-6)


def test_triangles_are_as_far_away_as_the_posed_body_has_them() -> None:
    model = build_model(1.75, full_body())
    rng = np.random.default_rng(2)
    body, n = Shaper(model)(np.ones(model.n_shape)), len(model.parents)
    R, joints = (
        rotations.to_matrix(rotations.exp(rng.normal(0.0, 0.5, (n, 3)))),
        rng.normal(0.0, 0.5, (n, 3)),
    )
    triangle = rng.integers(0, len(model.triangles), 50)
    origin, along = centre(LEFT), rng.normal(0.0, 1.0, (50, 3))
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    out = np.empty(50)
    distances_of_triangles(
        triangle, model.triangle_bones, model.triangle_weights, body.centres, body.rest, R, joints, origin, along, out
    )  # fmt: skip
    for k, t in enumerate(triangle):
        bones, weights = model.triangle_bones[t], model.triangle_weights[t]
        middle = sum(
            w * (R[j] @ (body.centres[t] - body.rest[j]) + joints[j])
            for j, w in zip(bones, weights, strict=True)
        )
        assert out[k] == pytest.approx(float((middle - origin) @ along[k]))
