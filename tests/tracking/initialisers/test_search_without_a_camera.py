"""A search for a person takes several frame sets, and a camera may be absent from the later ones."""

from collections.abc import Iterable
from types import SimpleNamespace
from typing import Any

import pytest

from tests.tracking.initialisers.test_first_pose_all_around import Keypoints, search_among
from tests.tracking.initialisers.test_standing_initialiser import turned

pytestmark = pytest.mark.kernels


class Asked(Keypoints):
    """Keeps in which cameras it looks for keypoints."""

    def __init__(self, true_rad: float) -> None:
        super().__init__(true_rad)
        self.cameras: list[int] = []

    def term(self, _: object, found: Iterable[int]) -> tuple[Keypoints]:
        self.cameras.extend(found)
        return (self,)


def test_keypoints_are_looked_for_in_the_cameras_that_are_there() -> None:
    """The process ended: the camera's picture had been there when the search began."""
    state, keypoints = turned(0.7), Asked(0.7)
    search = search_among([state], keypoints)
    del search._views.present[1]
    fit: Any = SimpleNamespace(state=state, explained=0.8)
    candidate: Any = SimpleNamespace(views=(), person=SimpleNamespace(blobs=range(4)))
    assert search._as_person(fit, candidate) is fit
    assert keypoints.cameras == [0, 2, 3]
