"""Labels of the body's surface, which the fit compares with the labels of the pictures."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.body.areas import on_arms
from mocapd.types import Bytes, Ints

MAX_LABELS = 16  # all labels are smaller: kernels have a bit or a list of each


@dataclass(frozen=True, slots=True, eq=False)
class SurfaceLabels:
    """T triangles of a body, of which S on the arms have a label. Labels are those that a picture's pixels get."""

    label: Bytes  # (T,) 0: has none
    area: Bytes  # (T,) the `Area` where its pixels are counted
    arms: Ints  # (S,) triangles by label: the picture may show them where the body as drawn hides them
    arms_start: Ints  # (MAX_LABELS + 1,) first place in `arms` of each label, and the end


def surface_labels(label: NDArray[np.uint8], area: NDArray[np.uint8]) -> SurfaceLabels:
    """Labels and areas (T,) of a body's triangles."""
    labelled = np.flatnonzero(on_arms(area) & (label > 0))
    arms = labelled[np.argsort(label[labelled], kind="stable")]
    start = np.searchsorted(label[arms], np.arange(MAX_LABELS + 1))
    return SurfaceLabels(label, area, arms, start)
