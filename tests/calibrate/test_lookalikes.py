"""Things beside the wearer in the shirt's colours are outlined and named."""

import cv2
import numpy as np

from mocapd.calibrate.colours.lookalikes import hull_of, lookalike_warning, lookalikes
from tests.calibrate.swatches import MODEL, NAMES

W, H = 320, 240
LIGHT = np.array([1.1, 0.9, 0.7])


def _room(things: list[tuple[int, tuple[int, int, int, int]]]) -> tuple[np.ndarray, np.ndarray]:
    """A grey room with boxes (colour id, x0 y0 x1 y1), the first five being the wearer's shirt."""
    rgb = np.full((H, W, 3), 0.5)
    shirt = np.zeros((H, W), np.uint8)
    worn = [(k, (130 + 12 * k, 90, 142 + 12 * k, 150)) for k in range(1, 6)]
    for k, (x0, y0, x1, y1) in worn:
        shirt[y0:y1, x0:x1] = k
    for k, (x0, y0, x1, y1) in worn + things:
        rgb[y0:y1, x0:x1] = MODEL.mean[k - 1]
    bgr = (255 * np.clip(rgb * LIGHT, 0, 1)).astype(np.uint8)[..., ::-1]
    return np.ascontiguousarray(bgr), shirt


def test_a_bare_room_has_none() -> None:
    pixels, shirt = _room([])
    found = lookalikes(pixels, shirt, MODEL, np.diag(1 / LIGHT))
    assert found == ()
    assert lookalike_warning(found, (W, H)) == ""


def test_boxes_are_outlined_and_named_largest_first() -> None:
    boxes = [(7, (10, 10, 60, 50)), (10, (20, 180, 100, 230))]
    pixels, shirt = _room(boxes)
    found = lookalikes(pixels, shirt, MODEL, np.diag(1 / LIGHT))
    assert [one.name for one in found] == [NAMES[9], NAMES[6]]
    for one, (_, (x0, y0, x1, y1)) in zip(found, boxes[::-1], strict=True):
        drawn = np.zeros((H, W), np.uint8)
        cv2.fillPoly(drawn, [one.polygon_px.astype(np.int32)], 1)
        truth = np.zeros((H, W), np.uint8)
        truth[y0:y1, x0:x1] = 1
        assert (drawn & truth).sum() > 0.9 * (drawn | truth).sum()
    sentence = lookalike_warning(found, (W, H))
    assert "pink (bottom left)" in sentence
    assert "blue (top left)" in sentence


def test_specks_do_not_count() -> None:
    pixels, shirt = _room([(7, (10, 10, 16, 16))])
    assert lookalikes(pixels, shirt, MODEL, np.diag(1 / LIGHT)) == ()


def test_sparse_strokes_cover_the_wearer_by_their_hull() -> None:
    pixels, shirt = _room([])
    sparse = np.zeros_like(shirt)
    sparse[::12] = shirt[::12]
    sparse[:, ::9] = shirt[:, ::9]
    assert lookalikes(pixels, hull_of(sparse), MODEL, np.diag(1 / LIGHT)) == ()
    assert not hull_of(np.zeros_like(shirt)).any()
