"""A search for a person takes several frame sets, and a camera may be absent from the later ones."""

from types import SimpleNamespace
from typing import Any

import pytest

from mocapd.tracking.cues.clothes.clothes_params import KeypointDetectionParams
from mocapd.tracking.cues.keypoints.keypoint_detection import (
    KeypointDetectors,
)


def test_keypoints_are_looked_for_in_the_cameras_that_are_there(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The process ended: the camera's picture had been there when the search began."""
    detectors = KeypointDetectors(4, 1.75, KeypointDetectionParams())
    cameras: Any = SimpleNamespace(present=dict.fromkeys((0, 2, 3), 0.0), each=[None] * 4)
    nothing: Any = None
    looked_in: list[int] = []
    monkeypatch.setattr(KeypointDetectors, "_detect", lambda *args: looked_in.append(args[2]))
    for i in range(4):
        detectors.detect(nothing, nothing, (nothing, nothing), cameras, i)
    assert looked_in == [0, 2, 3]
