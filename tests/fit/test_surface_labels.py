"""Labels of a surface, and where those of the arms are."""

import numpy as np

from mocapd.body.areas import Area
from mocapd.body.model import build_model
from mocapd.body.surface import LEFT_ARM, RIGHT_ARM
from mocapd.fit.surface_labels import MAX_LABELS, surface_labels

MODEL = build_model(1.75)


def test_triangles_of_the_arms_are_found_by_their_label() -> None:
    label = np.random.default_rng(0).integers(0, MAX_LABELS, len(MODEL.area)).astype(np.uint8)
    labels = surface_labels(label, MODEL.area)
    on_arms = np.isin(MODEL.part, (LEFT_ARM, RIGHT_ARM)) & (MODEL.area >= Area.LEFT_SHOULDER)
    for k in range(1, MAX_LABELS):
        mine = labels.arms[labels.arms_start[k] : labels.arms_start[k + 1]]
        np.testing.assert_array_equal(mine, np.flatnonzero(on_arms & (label == k)))
    assert labels.arms_start[1] == 0
    assert len(labels.arms) == labels.arms_start[-1]
