"""Where an uncalibrated camera is taken to stand: before a person who faces +Z."""

import numpy as np
import pytest

from mocapd.geometry.camera_model import centre, project
from mocapd.geometry.nominal_rig import nominal_rig


def test_it_looks_at_the_play_area_from_the_front() -> None:
    (camera,) = nominal_rig("cam0", (640, 480)).cameras
    np.testing.assert_allclose(centre(camera), [0.0, 1.2, 2.5])
    np.testing.assert_allclose(project(camera, np.array([0.0, 1.2, 0.0])), [319.5, 239.5])
    left_px = project(camera, np.array([0.5, 1.2, 0.0]))
    above_px = project(camera, np.array([0.0, 1.7, 0.0]))
    assert left_px[0] > 319.5  # the left of a person who faces the camera is on its right
    assert above_px[1] < 239.5
    assert np.isclose(np.linalg.det(camera.R), 1.0)


@pytest.mark.parametrize("size_px", [(640, 480), (1080, 1920)])
def test_sixty_degrees_span_the_longer_side(size_px: tuple[int, int]) -> None:
    (camera,) = nominal_rig("cam0", size_px).cameras
    np.testing.assert_allclose(
        np.degrees(2.0 * np.arctan(0.5 * max(size_px) / camera.K[0, 0])), 60.0
    )
