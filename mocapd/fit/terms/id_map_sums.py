"""One camera's share of the normal equations: the body as drawn, aligned with the picture as classified."""

import numpy as np
from numpy.typing import NDArray

from mocapd.body.areas import N_AREAS
from mocapd.body.arrays import PinholeArrays, PosedJoints, plain
from mocapd.body.derivative_kernels import joint_shape_derivatives
from mocapd.body.model import BodyModel
from mocapd.body.skeleton import N_JOINTS
from mocapd.fit.surface_labels import SurfaceLabels
from mocapd.fit.terms.id_map_kernels import (
    AreaCounts,
    ComparedPictures,
    LabelledTriangles,
    Search,
    pull_triangles,
)
from mocapd.fit.terms.triangle_rows_kernels import add_triangle_rows
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


class CameraSums:
    """What one camera's picture says of the drawn body: H (P,P) and b (P,) by the number of unknowns, the pixels by area,
    and the cost."""

    def __init__(self, model: BodyModel, labels: SurfaceLabels) -> None:
        P = model.n_pose + model.n_shape
        H, b = np.zeros(P * P), np.zeros(P)
        self.by_size = {n: (H[: n * n].reshape(n, n), b[:n]) for n in (model.n_pose, P)}
        self.counts = AreaCounts(*(np.zeros(N_AREAS) for _ in range(3)))
        self.cost = 0.0
        self._labelled = plain(
            LabelledTriangles(model.triangles, labels.area, labels.arms, labels.arms_start)
        )
        self._surface, self._articulation = plain(model.surface), plain(model.articulation)
        self._pulls = np.zeros((len(model.triangles), 5))
        self._d_joints = np.zeros((model.n_shape, N_JOINTS, 3))

    def gather(
        self,
        pictures: ComparedPictures,
        search: Search,
        xy: Floats,
        centres: Floats,
        posed: PosedJoints,
        camera: PinholeArrays,
        n_unknown: int,
        weight: float,
    ) -> None:
        """Sum again.

        pictures: on the search's grid, as xy (V,2), the vertices as drawn [px]; centres (T,3): of the triangles in the
        T-pose [m]; n_unknown: those of the pose, or of pose and shape; weight: of a pixel's row.
        """
        H, b = self.by_size[n_unknown]
        for array in (H, b, *self.counts):
            array[:] = 0.0
        self.cost = pull_triangles(
            plain(pictures),
            plain(search),
            xy,
            self._labelled,
            weight,
            plain(self.counts),
            self._pulls,
        )
        parents, *_, joint_of_group, d_rest = self._articulation
        if n_unknown > 3 + 3 * len(joint_of_group):
            joint_shape_derivatives(parents, d_rest, posed.R, self._d_joints)
        add_triangle_rows(
            self._pulls, centres, self._surface, self._articulation, plain(posed), self._d_joints, plain(camera), H, b
        )  # fmt: skip
