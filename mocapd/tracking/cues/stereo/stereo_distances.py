"""How far away the body is, where two cameras look from about the same side and see its cloth alike."""

from collections.abc import Collection, Sequence

import cv2
import numpy as np

from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.distance_term import DistanceTerm
from mocapd.fit.terms.stereo_match_term import StereoMatchParams, measured_distances
from mocapd.fit.terms.term import Term
from mocapd.fit.view import View
from mocapd.types import Bytes, FrameSet


def grey_pictures(fitter: Fitter, views: Sequence[View], frames: FrameSet) -> list[Bytes]:
    """The pictures of these views in grey, as delivered."""

    def grey(view: View) -> Bytes:
        pixels = frames.frames[fitter.drawings[view.index].camera.name].pixels
        return np.asarray(cv2.cvtColor(pixels, cv2.COLOR_BGR2GRAY), np.uint8)

    return list(fitter.each(grey, views))


def stereo_distance_terms(
    fitter: Fitter,
    predicted: MotionState,
    views: Sequence[View],
    frames: FrameSet,
    frame_index: int,
    params: StereoMatchParams,
    only: Collection[int] = (),
) -> tuple[Term, ...]:
    """Distances of the predicted body, which the fitter drew last into every view; none where cameras see other sides.

    turn: a running number, by which other points are taken; only: ids of the body's, where not all are wanted.
    """
    if len(views) != 2 or not fitter.has_small_baseline(predicted, views):
        return ()
    drawing, other = (fitter.drawings[view.index] for view in views)
    first, second = grey_pictures(fitter, views, frames)
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
