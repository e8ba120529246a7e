"""Alternates between pose and light of a body in still pictures, at the work resolution of one rig.

The fitted body gives the patch of each pixel, so the patches give the white balance. The picture is
classified again under that light and the body fitted again, until neither improves.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mocapd.body.model import build_model
from mocapd.fit.fit_result import Fit, confirmed_parts
from mocapd.fit.limbs.arm_search import ArmSearch
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.view import View
from mocapd.fit.work_size import image_scales
from mocapd.geometry.camera_model import to_camera
from mocapd.shirt.colour.colour_model import ColourModel
from mocapd.shirt.colour.strokes import COLOURS
from mocapd.shirt.colour.white_balance import shade_precision, solve_white_balance
from mocapd.shirt.garment import confirmed_colours, shirt_labels
from mocapd.shirt.segmentation.camera_segmenter import CameraSegmenter
from mocapd.shirt.segmentation.segmentation_kernels import colour_statistics
from mocapd.shirt.segmentation.shirt_appearance import ShirtAppearance
from mocapd.tracking.cues.shirt.shirt_params import ShirtParams
from mocapd.types import Camera

# rounds in a row without improvement: with one camera, pose and light then drift together
IDLE_TURNS = 2
LOOSE_S = 0.1
_NEAREST_M = 0.8  # a webcam sees no whole upper body nearer than that


@dataclass(frozen=True, slots=True, eq=False)
class Reading:
    """A picture read in one light: the fitted body, its view, the appearance of the colours, the agreement 0..1
    (the share of the rendered shirt that the picture confirms, minus shirt colours elsewhere), and the number of
    confirmed colours."""

    fit: Fit
    view: View
    appearance: ShirtAppearance
    agreement: float
    colours: int

    @property
    def score(self) -> float:
        """The score for comparing readings. A whole shirt shows all of its colours from every side, so a
        candidate with few of them, however good the agreement, is a bookshelf."""
        return self.agreement * self.colours / COLOURS


class LightRefinement:
    """The body's fitter and one segmenter a camera; has buffers, and each segmenter has its light."""

    def __init__(
        self, cameras: Sequence[Camera], model: ColourModel, stature_m: float, params: ShirtParams
    ) -> None:
        self._params, self._model = params, model
        scales = image_scales(cameras, params.fit.work_width_px)
        body = build_model(stature_m)
        self.fitter = Fitter(body, shirt_labels(body), tuple(cameras), scales, params.fit)
        self.segmenters = [
            CameraSegmenter(c, f, model, np.eye(3), params.segmentation)
            for c, f in zip(cameras, scales, strict=True)
        ]
        self._arms = ArmSearch(self.fitter, params.limbs)
        self._precision = shade_precision(model)

    def follow(self, index: int, fit: Fit, start: ShirtAppearance, turns: range) -> Reading | None:
        """Alternates pose and light; returns the best result, None when the body leaves the picture."""
        self.segmenters[index].memory.appearance = start
        best: Reading | None = None
        idle = 0
        for turn in turns:
            view = self.classify(index, fit)
            if view is None or idle == IDLE_TURNS:
                break
            idle += 1
            fit = self.fit(fit.state, [view], turn)
            appearance = self.segmenters[index].memory.appearance
            agreement, colours = fit.explained, confirmed_colours(fit)
            reading = Reading(fit, view, appearance, agreement, colours)
            if best is None or reading.score > best.score:
                best, idle = reading, 0
            self.update_light(index, fit.state, view)
        return best

    def fit(self, state: MotionState, views: list[View], turn: int) -> Fit:
        """The body in these views, with a search for its arms."""
        fit = self.fitter.fit(state, views, LOOSE_S, self._params.fit.iterations)
        return self._arms.improve(fit, views, LOOSE_S, turn)[0]

    def classify(self, index: int, fit: Fit) -> View | None:
        """The picture's colours, given the last pose; None when the body left the picture."""
        drawing = self.fitter.drawings[index]
        if to_camera(drawing.camera, fit.state.root_m)[2] < _NEAREST_M:
            return None
        roi = drawing.region(fit.state, 0.0, self._params.segmentation.uncertain_margin_px)
        if roi is None:
            return None
        predicted = drawing.render(fit.state, 0.0, roi)
        # no arm counts as uncertain: a wide search would find its colours in the room, whose background
        # is not yet available
        ids, pixel_weight = self.segmenters[index].classify(
            predicted, drawing, roi, np.empty(0, np.int64), may_relight=True
        )
        return View(index, roi, ids.copy(), pixel_weight.copy(), 0.0)

    def update_light(self, index: int, state: MotionState, view: View) -> None:
        """Set the white balance that the fitted body's patches give."""
        segmenter = self.segmenters[index]
        rendered = self.fitter.drawings[index].render(state, 0.0, view.roi)
        sums = np.zeros((10, 4))
        colour_statistics(
            segmenter.picture, view.roi[0], view.roi[1], rendered, view.ids, True, sums
        )
        n = sums[:, 0]
        means = sums[:, 3:0:-1] / np.maximum(n, 1.0)[:, None]
        before = segmenter.memory.appearance.W
        W = solve_white_balance(means, self._model.mean, n, before, precision=self._precision)
        segmenter.memory.appearance = ShirtAppearance(W, sums)

    def judged_alone(self, reading: Reading) -> Reading:
        """The reading with the agreement of its own camera alone."""
        view = reading.view
        drawing = self.fitter.drawings[view.index]
        rendered = drawing.render(reading.fit.state, view.dt_s, view.roi)
        n = np.bincount(rendered.ravel(), minlength=COLOURS + 1)[1:]
        same = np.bincount(rendered[rendered == view.ids], minlength=COLOURS + 1)[1:]
        return replace(
            reading,
            agreement=float(same.sum() / max(n.sum(), 1)),
            colours=int(np.count_nonzero(confirmed_parts(same, n))),
        )
