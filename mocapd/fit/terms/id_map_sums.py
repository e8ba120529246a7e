"""One camera's share of the normal equations: the body as drawn, aligned with the picture as classified."""

import numpy as np
from numpy.typing import NDArray

from mocapd.body.areas import N_AREAS
from mocapd.body.arrays import Articulation, PinholeArrays, PosedJoints, TriangleArrays
from mocapd.body.model import BodyModel
from mocapd.body.posing_kernels import joint_shape_derivatives
from mocapd.body.shaping import Shaped
from mocapd.body.skeleton import N_JOINTS
from mocapd.fit.idmap_renderer import IdMapRenderer
from mocapd.fit.surface_labels import SurfaceLabels
from mocapd.fit.terms.id_map_kernels import AlignmentSums, ComparedPictures, Search, accumulate
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


def sum_rows(
    pictures: ComparedPictures,
    search: Search,
    xy: Floats,
    surface: TriangleArrays,
    labels: SurfaceLabels,
    centres: Floats,
    articulation: Articulation,
    posed: PosedJoints,
    d_joints: Floats,
    camera: PinholeArrays,
    weight: float,
    sums: AlignmentSums,
) -> float:
    """Fill the sums with a camera's rows; the summed robust cost.

    xy (V,2): the vertices as drawn [px of the pictures]; centres (T,3) of the triangles in the T-pose;
    weight: of a pixel's row. d_joints (N,J,3) is scratch. H has columns for the pose alone, or for pose
    and shape.
    """
    for array in sums:
        array[:] = 0.0
    triangles, bones, weights, d_centres = surface
    parents, group_of_joint, share_of_joint, joint_of_group, d_rest = articulation
    rest, R, joints, _ = posed
    n_shape = len(sums.b) - 3 - 3 * len(joint_of_group)
    if n_shape > 0:
        joint_shape_derivatives(parents, d_rest, R, d_joints)
    cost: float = accumulate(
        *pictures, search.offsets, len(search.offsets), search.grid_px, search.radius_px,
        search.robust_px, search.phase, search.every, search.edge_weight, xy,
        triangles, labels.arms, labels.arms_start, labels.area, centres, d_centres, bones, weights,
        rest, d_rest, parents, group_of_joint, share_of_joint,
        R, joints, d_joints, n_shape, *camera, weight, *sums,
    )  # fmt: skip
    return cost


class CameraSums:
    """The sums of one camera, by how many unknowns there are, its counts (A,) by area and its cost."""

    def __init__(self, model: BodyModel) -> None:
        P = model.n_pose + model.n_shape
        H, b = np.zeros(P * P), np.zeros(P)
        counts = [np.zeros(N_AREAS) for _ in range(3)]
        self.by_size = {
            n: AlignmentSums(H[: n * n].reshape(n, n), b[:n], *counts) for n in (model.n_pose, P)
        }
        self.visible, self.matched, self.unexplained = counts
        self._d_joints = np.zeros((model.n_shape, N_JOINTS, 3))
        self.cost = 0.0

    def gather(
        self,
        drawing: IdMapRenderer,
        body: Shaped,
        pictures: ComparedPictures,
        search: Search,
        n_unknown: int,
        weight: float,
    ) -> None:
        """Recompute the sums from the body that `drawing` posed last; pictures: on the search's grid; n_unknown: of the pose,
        or of pose and shape; weight: of a pixel's row."""
        m = drawing.model
        self.cost = sum_rows(
            pictures, search, drawing.xy if search.grid_px == 1.0 else drawing.coarse_xy, m.surface, drawing.labels,
            body.centres, m.articulation, drawing.posed, self._d_joints, drawing.pinhole, weight,
            self.by_size[n_unknown],
        )  # fmt: skip
