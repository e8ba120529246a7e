"""Frusta as quadrilaterals: as the camera model says, around the round part, and sane where nothing can be seen."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocapd.geometry.camera_model import project, to_camera
from mocapd.published.hecht2009.cylinders.cylinder_projection_kernels import (
    pixel_at,
    project_parts,
)
from mocapd.published.hecht2009.cylinders.work_camera import work_camera
from mocapd.types import Camera, Floats
from tests.published.hecht2009.cylinders.naive import (
    ENDS_M,
    RADII_M,
    WORK_PX,
    camera,
    naive_quad,
)


def quads_of(of: Camera, ends_m: Floats, radii_m: Floats) -> tuple[Floats, Floats]:
    quads, depths = np.empty((len(ends_m), 4, 2)), np.empty((len(ends_m), 2))
    project_parts(ends_m, radii_m, work_camera(of, WORK_PX), quads, depths)
    return quads, depths


@pytest.mark.parametrize("x_m", [-1.2, 0.0, 0.8])
def test_corners_are_those_of_the_camera_model(x_m: float) -> None:
    of = camera(x_m)
    quads, depths = quads_of(of, ENDS_M, RADII_M)
    for quad, depth, ends, radii in zip(quads, depths, ENDS_M, RADII_M, strict=True):
        assert quad == pytest.approx(naive_quad(of, ends[0], ends[1], radii), abs=1e-9)
        assert depth == pytest.approx(to_camera(of, ends)[:, 2])


def test_a_quad_is_as_wide_and_long_as_the_round_part_looks() -> None:
    of = camera(0.3)
    (quad,), _ = quads_of(of, ENDS_M[3:4], RADII_M[3:4])
    a, b = ENDS_M[3]
    axis = (b - a) / np.linalg.norm(b - a)
    u = np.cross(axis, [0.0, 1.0, 0.0])
    u /= np.linalg.norm(u)
    turn = np.linspace(0.0, 2 * np.pi, 200)[:, None]
    across = quad[3] - quad[0]
    across /= np.linalg.norm(across)
    for place, radius, corner in ((a, RADII_M[3, 0], (0, 3)), (b, RADII_M[3, 1], (1, 2))):
        ring = place + radius * (np.cos(turn) * u + np.sin(turn) * np.cross(axis, u))
        seen = ((project(of, ring) + 0.5) * 0.5 - 0.5) @ across
        width = np.ptp(seen)
        assert np.linalg.norm(quad[corner[1]] - quad[corner[0]]) == pytest.approx(width, rel=0.06)


@given(st.floats(0.02, 1.2), st.floats(-3.14, 3.14))
def test_pixels_agree_with_the_camera_model_over_the_whole_picture(r: float, turn: float) -> None:
    of = camera(k1=-0.05)
    work = work_camera(of, WORK_PX)
    xy = min(r, work.far_r2**0.5) * np.array([np.cos(turn), np.sin(turn)])
    point = of.R.T @ (np.array([*xy, 1.0]) * 2.0 - of.t_m)
    expected = (project(of, point) + 0.5) * 0.5 - 0.5
    got = pixel_at(work.K, work.dist, work.far_r2, *(2.0 * np.array([*xy, 1.0])))
    assert np.array(got) == pytest.approx(expected, abs=1e-6)


def test_what_is_far_outside_of_a_strong_lens_does_not_come_back_into_the_picture() -> None:
    of = camera(k1=-0.45)  # its polynomial turns back at 41 degrees
    work = work_camera(of, WORK_PX)
    places = [
        np.hypot(*(np.array(pixel_at(work.K, work.dist, work.far_r2, r, 0.0, 1.0)) - work.K[2:]))
        for r in np.linspace(0.0, 8.0, 200)
    ]
    assert (np.diff(places) > 0.0).all()


def test_a_part_along_the_ray_and_one_behind_the_camera() -> None:
    of = camera()
    eye = -of.R.T @ of.t_m
    forward = of.R[2]
    along = np.array([eye + 2.0 * forward, eye + 2.3 * forward])
    behind = np.array([eye - 0.5 * forward, eye + 1.0 * forward])
    quads, _ = quads_of(of, np.array([along, behind]), np.full((2, 2), 0.05))
    assert np.isfinite(quads[0]).all()
    assert np.linalg.norm(quads[0, 0] - quads[0, 3]) == pytest.approx(280 * 0.1 / 2.0, rel=0.02)
    assert np.isnan(quads[1]).all()
