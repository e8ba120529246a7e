"""Finds the head of an upright person by the foreground, without a face: for small or dark heads."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mocapd.published.hecht2009.evidence import CameraEvidence
from mocapd.tracking.cues.clothes.clothes_params import StartParams
from mocapd.tracking.initialisers.standing_initialiser import blobs_of, person_candidates
from mocapd.types import Floats

_HEAD_MIDDLE = 0.935  # of the stature, above the floor
_LOOKS = 3  # with a person in one place
_SAME_PLACE_M = 0.25
_MOST_ERROR_PX2 = 100.0  # of each camera: blob and person agree within 10 work px


@dataclass(frozen=True, slots=True, eq=False)
class UprightHead:
    """middle_m (3,): the head's last middle [m]; looks: number of successive looks with it there."""

    middle_m: Floats
    looks: int

    @property
    def is_sure(self) -> bool:
        """True after enough looks."""
        return self.looks >= _LOOKS


def find_upright_head(
    views: Sequence[CameraEvidence], last: UprightHead | None, stature_m: float
) -> UprightHead | None:
    """The head of the best upright figure; None without one, or where fewer than two cameras show it."""
    if len(views) < 2 or any(view.background.is_new for view in views):
        return None
    start = StartParams()
    blobs = {k: blobs_of(view.before, True, start) for k, view in enumerate(views)}
    found = person_candidates(
        blobs,
        [view.camera for view in views],
        [view.image_scale for view in views],
        stature_m,
        start,
    )
    if not found or found[0].error > _MOST_ERROR_PX2 * len(views):
        return None
    middle = found[0].place_m + np.array([0.0, _HEAD_MIDDLE * stature_m, 0.0])
    if last is None or float(np.linalg.norm(last.middle_m - middle)) > _SAME_PLACE_M:
        return UprightHead(middle, 1)
    return UprightHead(middle, last.looks + 1)
