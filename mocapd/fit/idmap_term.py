"""One camera's rows of the fit: the body as drawn, aligned with the picture as classified."""

import numpy as np
from numpy.typing import NDArray

from mocapd.body.arrays import plain
from mocapd.body.model import BodyModel
from mocapd.body.shaping import Shaped
from mocapd.body.shirt import N_LABELS
from mocapd.body.skeleton import N_JOINTS
from mocapd.fit.body_drawing import IdMapRenderer
from mocapd.fit.idmap_term_kernels import (
    AlignmentSums,
    ComparedPictures,
    Search,
    accumulate,
)
from mocapd.types import Floats

_ROBUST = 0.6  # of the search radius: where a residual has lost half of its weight


def search_within(
    offsets: NDArray[np.int32],
    radius_px: float,
    grid_px: float,
    every: int,
    phase: int,
    edge_weight: float,
) -> Search:
    """A search within radius_px [work px], robust in proportion to it; see `Search`."""
    return Search(offsets, radius_px, _ROBUST * radius_px, grid_px, every, phase, edge_weight)


class CameraRows:
    """One camera's share of the normal equations: H (P,P), b (P,), counts (21,) per patch, cost."""

    def __init__(self, model: BodyModel) -> None:
        P = model.n_pose + model.n_shape
        H, b = np.zeros(P * P), np.zeros(P)
        self.visible, self.matched, self.unexplained = (np.zeros(N_LABELS) for _ in range(3))
        self._systems = {n: (H[: n * n].reshape(n, n), b[:n]) for n in (model.n_pose, P)}
        self._tables = plain(model.surface), plain(model.articulation)
        self._d_joints = np.zeros((model.n_shape, N_JOINTS, 3))
        self.cost = 0.0

    def gather(
        self,
        drawing: IdMapRenderer,
        body: Shaped,
        pictures: ComparedPictures,
        search: Search,
        n_shape: int,
        weight: float,
    ) -> None:
        """Add up anew, from the body that `drawing` posed last; the pictures are on the search's grid.

        n_shape: how many shape factors are columns after those of the pose, none or all. weight: of a
        pixel's row.
        """
        surface, articulation = self._tables
        sums = AlignmentSums(
            *self._systems[drawing.model.n_pose + n_shape],
            self.visible,
            self.matched,
            self.unexplained,
        )
        self.cost = accumulate(
            plain(pictures), plain(search),
            drawing.xy if search.grid_px == 1.0 else drawing.coarse_xy,
            surface, body.centres, articulation, plain(drawing.posed), self._d_joints,
            plain(drawing.pinhole), weight, plain(sums),
        )  # fmt: skip

    def system(self, P: int) -> tuple[Floats, Floats]:
        """H and b as last added up."""
        return self._systems[P]
