"""The id maps of all cameras as a term: the body as drawn, aligned with each picture as classified."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, partial

import numpy as np

from mocapd.body.areas import N_AREAS
from mocapd.body.model import BodyModel, Shaped
from mocapd.each import Each
from mocapd.fit.fit_params import FitParams
from mocapd.fit.idmap_renderer import IdMapRenderer
from mocapd.fit.motion_state import MotionState, predict_pose
from mocapd.fit.terms.id_map_kernels import AreaCounts, ComparedPictures, Search
from mocapd.fit.terms.id_map_sums import CameraSums, search_within
from mocapd.fit.terms.nearest_pixel_kernels import offsets_by_distance
from mocapd.fit.view import View
from mocapd.types import Floats

_NO_PIXELS = np.zeros(N_AREAS)


@dataclass(frozen=True, slots=True, eq=False)
class _Iteration:
    """Inputs of one iteration for all cameras; n_unknown: of pose, or of pose and shape."""

    state: MotionState
    body: Shaped
    search: Search
    n_unknown: int
    redraw: bool


class IdMapTerm:
    """Id maps of all cameras against one body. Each camera's sums are those of the last `system`."""

    def __init__(
        self, drawings: Sequence[IdMapRenderer], model: BodyModel, params: FitParams, each: Each
    ) -> None:
        self._drawings, self._model, self._params, self._each = drawings, model, params, each
        self._cameras = [CameraSums(model, drawing.labels) for drawing in drawings]
        self._offsets = offsets_by_distance(params.first_radius_px)
        self._offsets_r2 = (self._offsets**2).sum(axis=1)
        self._search = cache(self._make_search)

    def search(self, along: float, fine: bool, phase: int) -> Search:
        """Of an iteration so far along, 0 the first, 1 the last: half of all pixels, or, not `fine`, a quarter, every second
        each way."""
        p = self._params
        return self._search(
            p.first_radius_px + along * (p.last_radius_px - p.first_radius_px), fine, phase
        )

    def _make_search(self, radius_px: float, fine: bool, phase: int) -> Search:
        grid_px = 1.0 if fine else 2.0
        n = np.searchsorted(self._offsets_r2, (radius_px / grid_px) ** 2, side="right")
        return search_within(
            self._offsets[:n], radius_px, grid_px,
            every=2 if fine else 1, phase=phase, edge_weight=self._params.edge_weight if fine else 0.0,
        )  # fmt: skip

    def system(
        self,
        state: MotionState,
        body: Shaped,
        views: Sequence[View],
        search: Search,
        n_shape: int,
        redraw: bool,
    ) -> tuple[Floats, Floats]:
        """H (P,P), b (P,) of all views, with pictures on the search's grid; n_shape: how many shape factors are unknowns
        after those of the pose, none or all. redraw: not, where the state was drawn last into every view."""
        P = self._model.n_pose + n_shape
        self._each(partial(self._gather, _Iteration(state, body, search, P, redraw)), views)
        H, b = np.zeros((P, P)), np.zeros(P)
        for view in views:
            camera_H, camera_b = self._cameras[view.index].by_size[P]
            H += camera_H
            b += camera_b
        return H, b

    def counts(self, views: Sequence[View]) -> AreaCounts:
        """Pixels of these views by area."""
        each = [self._cameras[view.index].counts for view in views]
        return AreaCounts(*(sum((one[i] for one in each), _NO_PIXELS) for i in range(3)))

    def cost(self, views: Sequence[View]) -> float:
        """Of these views [disagreeing pixels]."""
        return sum(self._cameras[view.index].cost for view in views)

    def _gather(self, one: _Iteration, view: View) -> None:
        """The rows of one camera, at its own instant."""
        m, coarse = self._model, one.search.grid_px > 1.0
        drawing = self._drawings[view.index]
        root_m, local_xyzw = predict_pose(m, one.state, view.dt_s)
        if one.redraw:
            draw = drawing.draw_coarse if coarse else drawing.draw
            drawn = draw(root_m, local_xyzw, one.body, view.roi)
        else:
            drawn = drawing.last_coarse(view.roi) if coarse else drawing.last(view.roi)
            drawing.pose(root_m, local_xyzw, one.body.rest)
        self._cameras[view.index].gather(
            ComparedPictures(*drawn, view.ids, view.pixel_weight), one.search,
            drawing.coarse_xy if coarse else drawing.xy, one.body.centres, drawing.posed, drawing.pinhole, one.n_unknown,
            self._params.row_weight,
        )  # fmt: skip
