"""How far away the body is, where two cameras look from about the same side and see its cloth alike; and the stereo depth of
their views, without pixels far behind the person."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace

import numpy as np

from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.stereo_depth import StereoDepthParams, StereoPair, stereo_depth_m
from mocapd.fit.terms.distance_term import DistanceTerm
from mocapd.fit.terms.stereo_match_term import StereoMatchParams, measured_distances
from mocapd.fit.terms.term import Term
from mocapd.fit.view import View
from mocapd.geometry.camera_model import centre
from mocapd.types import Bytes

GreyPicture = Callable[[int], Bytes]  # of the camera of an index, (h,w) as delivered
_SURE = np.uint8(255)


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


def add_stereo_depth(
    fitter: Fitter,
    predicted: MotionState,
    views: Sequence[View],
    grey: GreyPicture,
    params: StereoDepthParams,
) -> list[View]:
    """The views, with depths in the first one, for two cameras with a small baseline; unchanged otherwise.

    predicted: a body that the fitter rendered last into every view. Pixels classified outside it and far behind it (a
    passer-by, a ghost) are removed from its regions.
    """
    if len(views) != 2 or not fitter.has_small_baseline(predicted, views):
        return list(views)
    greys = fitter.each(grey, [view.index for view in views])
    out = []
    for mine, its in ((0, 1), (1, 0)):
        view, drawing = views[mine], fitter.drawings[views[mine].index]
        pair = StereoPair(
            drawing.camera, fitter.drawings[views[its].index].camera, (greys[mine], greys[its]), drawing.image_scale
        )  # fmt: skip
        outside = (view.ids > 0) & (drawing.last(view.roi)[0] == 0)
        far_m = stereo_depth_m(
            outside, view.roi, pair, predicted.root_m, params.room_m, params, fitter.each
        )
        away_m = float(np.linalg.norm(predicted.root_m - centre(drawing.camera)))
        behind = far_m > away_m + params.behind_m
        before = (view.ids > 0) | (view.pixel_weight < _SURE)
        view = replace(
            view, ids=np.where(behind, np.uint8(0), view.ids),
            pixel_weight=np.where(behind, _SURE, view.pixel_weight),
        )  # fmt: skip
        if mine == 0:
            depth_m = stereo_depth_m(
                before, view.roi, pair, predicted.root_m, params.farther_m, params, fitter.each
            )
            if np.isfinite(depth_m).any():
                view = replace(view, depth_m=depth_m)
        out.append(view)
    return out
