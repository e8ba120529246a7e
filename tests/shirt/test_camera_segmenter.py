"""What a camera's segmenter does now and then is done by the clock, at any frame rate and effort."""

import numpy as np
import pytest

from mocapd.fit.fit_params import TICK_S
from mocapd.shirt.segmentation.camera_segmenter import CameraSegmenter
from mocapd.shirt.segmentation.segmentation_params import SegmentationParams
from tests.fit.synthetic import CAMERAS, FACTOR, fitter, standing
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


@pytest.mark.kernels
@pytest.mark.parametrize("ticks", [(1,), (0, 1), (2,)])
def test_what_is_usual_is_forgotten_in_two_seconds_at_any_frame_rate(
    ticks: tuple[int, ...],
) -> None:
    """ticks: that pass with pictures in turn, at 30, 60 and 15 Hz."""
    segmenter = CameraSegmenter(
        CAMERAS[0], FACTOR, example_model(), np.eye(3), SegmentationParams()
    )
    w, h = segmenter.size
    drawing, roi = fitter(1).drawings[0], (0, 0, w, h)
    predicted = drawing.render(standing(), 0.0, roi)
    white, passed, frame = np.full((h, w, 3), 255, np.uint8), 0, 0
    segmenter.memory.usual = 1.0
    while passed < 60:
        count = ticks[frame % len(ticks)]
        frame, passed = frame + 1, passed + count
        segmenter.take(white, count)
        segmenter.classify(predicted, drawing, roi, np.empty(0, np.int64), may_relight=False)
    assert segmenter.memory.usual == pytest.approx(np.exp(-1.0), rel=0.01)
