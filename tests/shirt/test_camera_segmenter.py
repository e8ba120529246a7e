"""What a camera's segmenter does now and then is done by the clock, at any frame rate and effort."""

import numpy as np
import pytest

from mocapd.fit.fit_params import TICK_S
from mocapd.shirt.segmentation.camera_segmenter import CameraSegmenter
from mocapd.shirt.segmentation.segmentation_params import SegmentationParams
from tests.geometry.rigs import ring
from tests.shirt.example_colours import example_model


@pytest.mark.parametrize(
    ("ticks", "every"), [((1,), 1), ((0, 1), 1), ((2,), 2), ((1,), 2), ((0, 1), 4)]
)
def test_a_face_is_looked_at_ten_times_a_second(ticks: tuple[int, ...], every: int) -> None:
    """ticks: that pass with pictures in turn, at 30, 60 and 15 Hz; every: of so many ticks one teaches."""
    camera = ring(1)[0]
    segmenter = CameraSegmenter(camera, 2, example_model(), np.eye(3), SegmentationParams())
    w, h = segmenter.size
    picture, passed, looks, frame = np.zeros((h, w, 3), np.uint8), 0, 0, 0
    while passed < 600:
        count = ticks[frame % len(ticks)]
        frame, passed = frame + 1, passed + count
        segmenter.take(picture, count)
        if count and passed % every == 0:
            looks += segmenter.is_due_for_skin(every * TICK_S)
    assert looks == pytest.approx(200 if every < 4 else 150, abs=2)
