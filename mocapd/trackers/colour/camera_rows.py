"""One camera's rows of the fit: the body as drawn, aligned with the picture as classified."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.body.model import N_POSE, N_SHAPE
from mocapd.body.posing_kernels import joint_shape_derivatives
from mocapd.body.shaping import Shaped
from mocapd.body.skeleton import N_JOINTS
from mocapd.trackers.colour.alignment_kernels import accumulate
from mocapd.trackers.colour.drawing import Drawing
from mocapd.types import Floats

Picture = tuple[NDArray[np.uint8], NDArray[np.uint8]]  # ids and softness (h,w)
Drawn = tuple[NDArray[np.uint8], NDArray[np.int32]]  # ids and triangles (h,w)

_ROBUST = 0.6  # of the search radius: where a residual has lost half of its weight


@dataclass(frozen=True, slots=True, eq=False)
class Search:
    """Where colours are looked for: offsets (N,2) within radius_px [work px] on a grid of grid_px, at
    every or every second pixel of it (then those of `phase`), with so much weight on edges in place."""

    offsets: NDArray[np.int32]
    radius_px: float
    grid_px: float
    every: int
    phase: int
    stiffness: float


class CameraRows:
    """One camera's share of the normal equations: H (P,P), b (P,), counts (21,) per patch, cost."""

    def __init__(self, n_shape: int = N_SHAPE) -> None:
        """n_shape: how many factors the body's shape has."""
        P = N_POSE + n_shape
        self._H, self._b = np.zeros(P * P), np.zeros(P)
        self.visible, self.matched, self.unexplained = np.zeros(21), np.zeros(21), np.zeros(21)
        self._d_joints = np.zeros((n_shape, N_JOINTS, 3))
        self.cost = 0.0

    def gather(
        self,
        drawing: Drawing,
        body: Shaped,
        drawn: Drawn,
        picture: Picture,
        search: Search,
        n_shape: int,
        weight: float,
    ) -> None:
        """Add up anew, from the body that `drawing` posed last; drawn and picture are on the search's grid.

        n_shape: how many shape factors are columns after those of the pose. weight: of a pixel's row.
        """
        m, camera, factor = drawing.model, drawing.camera, drawing.factor
        joint_shape_derivatives(m.parents, m.d_rest, drawing.R, self._d_joints)
        H, b = self.system(N_POSE + n_shape)
        for array in (H, b, self.visible, self.matched, self.unexplained):
            array[:] = 0.0
        self.cost = accumulate(
            *drawn, *picture, search.offsets, len(search.offsets), search.grid_px,
            search.radius_px, _ROBUST * search.radius_px, search.phase, search.every, search.stiffness,
            drawing.xy if search.grid_px == 1.0 else drawing.coarse_xy,
            m.triangles, m.sleeves, m.sleeve_start, m.patch, body.centres, m.d_centres,
            m.triangle_bones, m.triangle_weights, body.rest, m.d_rest, m.parents,
            m.joint_of_group, m.group_of_joint, m.share_of_joint,
            drawing.R, drawing.joints, self._d_joints, n_shape, camera.R, camera.t_m,
            camera.K[0, 0] / factor, camera.K[1, 1] / factor, weight,
            H, b, self.visible, self.matched, self.unexplained,
        )  # fmt: skip

    def system(self, P: int) -> tuple[Floats, Floats]:
        """H and b as last added up."""
        return self._H[: P * P].reshape(P, P), self._b[:P]
