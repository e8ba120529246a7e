"""A head found without a face, where heads are small or dark: that of somebody who stands before the background."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mocapd.published.hecht2009.evidence import CameraEvidence
from mocapd.tracking.cues.clothes.clothes_params import StartParams
from mocapd.tracking.initialisers.stance import blobs_of, standing
from mocapd.types import Floats

_HEAD_MIDDLE = 0.935  # of the stature, above the floor
_LOOKS = 3  # at which somebody stood in one place
_SAME_PLACE_M = 0.25
_MOST_ERROR_PX2 = 100.0  # of each camera: blob and person agree within 10 work px


@dataclass(frozen=True, slots=True, eq=False)
class StandingHead:
    """middle_m (3,): the head's middle [m] as last seen; looks: how often in a row it was there."""

    middle_m: Floats
    looks: int

    @property
    def is_sure(self) -> bool:
        """Whether it was seen often enough."""
        return self.looks >= _LOOKS


def head_of_standing(
    views: Sequence[CameraEvidence], last: StandingHead | None, stature_m: float
) -> StandingHead | None:
    """The head of whoever stands best; None where nobody does, or fewer than two cameras see them."""
    if len(views) < 2 or any(view.background.is_new for view in views):
        return None
    start = StartParams()
    blobs = {k: blobs_of(view.before, True, start) for k, view in enumerate(views)}
    found = standing(
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
        return StandingHead(middle, 1)
    return StandingHead(middle, last.looks + 1)
