"""How far away the body is, where two cameras look from about the same side and see its cloth alike."""

from collections.abc import Callable, Collection, Sequence

import numpy as np

from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.distance_term import DistanceTerm
from mocapd.fit.terms.stereo_match_term import StereoMatchParams, measured_distances
from mocapd.fit.terms.term import Term
from mocapd.fit.view import View
from mocapd.types import Bytes

GreyPicture = Callable[[int], Bytes]  # of the camera of an index, (h,w) as delivered


def stereo_distance_terms(
    fitter: Fitter,
    predicted: MotionState,
    views: Sequence[View],
    grey: GreyPicture,
    frame_index: int,
    params: StereoMatchParams,
    only: Collection[int] = (),
) -> tuple[Term, ...]:
    """Distances of the predicted body, which the fitter drew last into every view; none where cameras see other sides.

    frame_index: a running number, by which other points are taken; only: ids of the body's, where not all are wanted.
    """
    if len(views) != 2 or not fitter.has_small_baseline(predicted, views):
        return ()
    drawing, other = (fitter.drawings[view.index] for view in views)
    first, second = fitter.each(grey, [view.index for view in views])
    body, roi = fitter.shaper(predicted.factors), views[0].roi
    ids, triangles = drawing.last(roi)
    if only:
        ids = np.where(np.isin(ids, list(only)), ids, np.uint8(0))
    measured = measured_distances(
        drawing,
        (ids, triangles),
        body,
        other.camera,
        (first, second),
        frame_index,
        roi[:2],
        params,
        fitter.each,
    )
    return (DistanceTerm(fitter.model, measured),)
