"""The segmenters of all cameras: pose-assisted classification, and updates from the fitted pose."""

from collections.abc import Mapping, Sequence

import numpy as np

from mocapd.body.areas import ARM_AREAS
from mocapd.each import in_turn
from mocapd.fit.fit_params import TICK_S
from mocapd.fit.fit_result import Fit
from mocapd.fit.idmap_renderer import Roi
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.view import View
from mocapd.shirt.colour.colour_model import ColourModel
from mocapd.shirt.segmentation.bare_skin import face_disc
from mocapd.shirt.segmentation.camera_segmenter import CameraSegmenter
from mocapd.shirt.segmentation.segmentation_params import SegmentationParams
from mocapd.shirt.standard_shirt import standard_shirt
from mocapd.types import Bytes, Floats, Ints
from mocapd.vision.room_background import RoomBackground


class RigSegmenter:
    """One `CameraSegmenter` for each camera of a fitter; `present` below is each present camera's own time after
    the frame set's [s], by its index."""

    def __init__(
        self,
        fitter: Fitter,
        model: ColourModel,
        white_balance: Mapping[str, Floats],
        params: SegmentationParams,
        backgrounds: Sequence[RoomBackground] | None = None,
    ) -> None:
        """white_balance: W (3,3) by camera name, identity where absent; backgrounds: of the cameras, which others learn;
        None: each segmenter learns its own."""
        self._fitter, self._params, self._each = fitter, params, fitter.each
        self.each = [
            CameraSegmenter(
                d.camera, d.image_scale, model,
                np.asarray(white_balance.get(d.camera.name, np.eye(3))), params,
                None if backgrounds is None else backgrounds[i],
            )
            for i, d in enumerate(fitter.drawings)
        ]  # fmt: skip

    def reset(self) -> None:
        """Forget light and background."""
        for segmenter in self.each:
            segmenter.reset()

    def take(self, pictures: Mapping[int, Bytes], ticks: int = 1) -> None:
        """Take work pictures (h,w,3), by camera, so many ticks of 1/30 s after the last ones."""
        for i, picture in pictures.items():
            self.each[i].take(picture, ticks)

    def views(
        self, state: MotionState, present: dict[int, float], uncertain: tuple[str, ...] = ()
    ) -> list[View]:
        """Classify every picture with the state as prior; `uncertain`: arms that are looked for farther away."""
        p = self._params
        margin = p.uncertain_margin_px if uncertain else p.margin_px
        colours = _colours_of(uncertain)

        def view(i: int) -> View | None:
            drawing, dt_s = self._fitter.drawings[i], present[i]
            drawn = drawing.render_about(state, dt_s, margin)
            if drawn is None:
                return None
            roi, predicted = drawn
            ids, pixel_weight = self.each[i].classify(
                predicted, drawing, roi, colours, may_relight=True
            )
            bare = self.each[i].bare(roi, ids) if uncertain else None
            return View(i, roi, ids, pixel_weight, dt_s, bare)

        return [one for one in self._each(view, present) if one is not None]

    def learn_with(
        self,
        state: MotionState,
        fit: Fit,
        views: list[View],
        redraw: bool,
        dt_s: float = TICK_S,
    ) -> None:
        """Follow the light, and where the body is, from a pose and its fit; dt_s: since pictures before these taught it.

        Without `redraw`, the last drawing of the fit will do: it differs by a fraction of a pixel.
        """
        sure = fit.match > self._params.sure_match

        def learn(view: View) -> None:
            segmenter, drawing = self.each[view.index], self._fitter.drawings[view.index]
            if redraw:
                final = drawing.render(state, view.dt_s, view.roi)
            else:
                final = drawing.last(view.roi)[0]
            segmenter.mark_body(final, view.roi)
            face = None
            if sure and segmenter.is_due_for_skin(dt_s):
                face = face_disc(
                    segmenter.camera,
                    drawing.posed,
                    self._fitter.model.stature_m,
                    segmenter.image_scale,
                )
            segmenter.learn(final, view.ids, view.pixel_weight, view.roi, dt_s, sure, face)

        # in turn, as the steps before and after: two threads take longer (docs/decisions/joint-heatmaps.md)
        in_turn(learn, views)

    def learn_background(self, present: dict[int, float], no_pose: bool, ticks: int = 1) -> None:
        """Follow the background, in the whole picture without a pose; ticks: see `RoomBackground.learn`."""

        def learn(i: int) -> None:
            segmenter = self.each[i]
            if no_pose:
                segmenter.mark_body(None, (0, 0, 0, 0))
            segmenter.learn_background(ticks)

        in_turn(learn, present)

    def roi_px(self, view: View) -> Roi:
        """A view's region in pixels of the frame itself."""
        image_scale = self.each[view.index].image_scale
        x0, y0, x1, y1 = (image_scale * edge for edge in view.roi)
        return x0, y0, x1, y1


def _colours_of(sides: tuple[str, ...]) -> Ints:
    """The colours (0..9) of the sleeves that are uncertain."""
    if not sides:
        return np.empty(0, np.int64)
    colours = [standard_shirt().colour_of_patch[ARM_AREAS[side]] for side in sides]
    return np.unique(np.concatenate(colours)).astype(np.int64) - 1
