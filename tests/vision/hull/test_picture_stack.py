"""Projections into work pictures."""

import numpy as np

from mocapd.vision.hull.picture_stack import stack_projections
from tests.vision.hull.ring_of_cameras import ring


def test_a_work_picture_that_lacks_the_last_columns_is_not_taken_for_the_whole_frame() -> None:
    (camera,) = ring(1, size_px=(1024, 768))
    corner_px = np.array([1019.0, 767.0])  # blocks of 3 pixels cover 1020 columns, both sides even
    (focal,) = stack_projections([camera], [(340, 256)]).focal_px
    distorted = (corner_px - camera.K[:2, 2]) / camera.K[[0, 1], [0, 1]]
    assert np.allclose(distorted * focal[:2] + focal[2:], (corner_px + 0.5) / 3 - 0.5)
