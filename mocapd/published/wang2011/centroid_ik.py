"""Step 4: inverse kinematics on patch centroids with three covariance terms."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.body.areas import N_AREAS
from mocapd.body.arrays import camera_arrays, pinhole_arrays, plain
from mocapd.body.model import BodyModel
from mocapd.body.posing_kernels import difference, retract
from mocapd.published.wang2011.covariances import Covariances
from mocapd.published.wang2011.drawing import (
    Grid,
    PatchRenderer,
    Posture,
    draw,
    posed_joints,
    posture,
    triangle_points,
)
from mocapd.published.wang2011.patch_kernels import centroid_rows
from mocapd.types import Camera, Floats

_FRAME_S = 1.0 / 30.0


@dataclass(frozen=True, slots=True, eq=False)
class Target:
    """Where a camera sees the patches: centroid (A,2) [px] of those `wanted` (A,), on a grid to draw on."""

    camera: Camera
    grid: Grid
    centroid_px: Floats
    wanted: NDArray[np.bool_]


class CentroidSolver:
    """Gauss-Newton on the energy of the paper; the body is redrawn in each iteration."""

    def __init__(self, model: BodyModel, covariances: Covariances, iterations: int) -> None:
        self.model, self.iterations = model, iterations
        self._points = triangle_points(model)
        self._centroid = np.linalg.inv(covariances.centroid)
        self._blend = np.linalg.inv(covariances.blend)
        self._previous = covariances.previous

    def solve(
        self,
        targets: Sequence[Target],
        blended: Posture,
        previous: Posture | None,
        elapsed_s: float,
        min_samples: int,
    ) -> Posture:
        """The pose q* next to the blended pose q^b and, if given, the one `elapsed_s` earlier, q^h."""
        body = blended
        if previous is not None:
            grown = max(elapsed_s / _FRAME_S, 0.5) ** 2
            from_previous = np.linalg.inv(self._previous * grown)
        for _ in range(self.iterations):
            gap = self._gap(body, blended)
            hessian, gradient = self._blend.copy(), self._blend @ gap
            if previous is not None:
                hessian += from_previous
                gradient += from_previous @ self._gap(body, previous)
            for target in targets:
                drawing = draw(self.model, body, target.camera, target.grid)
                wanted = target.wanted & (drawing.count >= min_samples)
                J, residual = self._rows(body, drawing, target, wanted)
                hessian += np.einsum("pik,ij,pjl->kl", J, self._centroid, J)
                gradient += np.einsum("pik,ij,pj->k", J, self._centroid, residual)
            step = -np.linalg.solve(hessian, gradient)
            root, local = np.empty(3), np.empty_like(body.local_xyzw)
            retract(
                body.root_m, body.local_xyzw, step, self.model.group_of_joint,
                self.model.share_of_joint, root, local,
            )  # fmt: skip
            body = posture(self.model, root, local)
        return body

    def _gap(self, a: Posture, b: Posture) -> Floats:
        out = np.empty(self.model.n_pose)
        difference(
            a.root_m, a.local_xyzw, b.root_m, b.local_xyzw,
            self.model.joint_of_group, self.model.share_of_joint, out,
        )  # fmt: skip
        return out

    def _rows(
        self, body: Posture, drawing: PatchRenderer, target: Target, wanted: NDArray[np.bool_]
    ) -> tuple[Floats, Floats]:
        """Jacobian (P,2,n_pose) and residual (P,2) [px] of the wanted patches."""
        model, camera = self.model, pinhole_arrays(camera_arrays(target.camera), 1.0)
        J = np.empty((N_AREAS, 2, model.n_pose))
        centroid_rows(
            drawing.samples, wanted, drawing.count, self._points, model.area, plain(model.surface),
            plain(model.articulation), plain(posed_joints(model, body)), plain(camera), J,
        )  # fmt: skip
        residual = target.grid.to_pixels(drawing.centroid[wanted]) - target.centroid_px[wanted]
        return J[wanted], residual
