"""The occlusion model of one picture from the body's parts."""

import numpy as np

from mocapd.published.hecht2009.cylinders.cylinder_projection_kernels import project_parts
from mocapd.published.hecht2009.cylinders.occlusion_kernels import (
    MOST_PARTS,
    OcclusionModel,
    index_parts,
)
from mocapd.published.hecht2009.cylinders.work_camera import WorkCamera
from mocapd.types import Floats


def allocate_occlusion(
    n_parts: int, work_size_px: tuple[int, int], cell_px: float
) -> OcclusionModel:
    """Room for that many parts in pictures (width, height); nothing hides anything yet. Raises ValueError for too many."""
    if n_parts > MOST_PARTS:
        raise ValueError(f"{n_parts} parts are more than {MOST_PARTS}")
    width, height = work_size_px
    return OcclusionModel(
        np.zeros((n_parts, 4, 3)),
        np.zeros((n_parts, 3)),
        np.zeros((n_parts, 2)),
        np.zeros((int(np.ceil(height / cell_px)), int(np.ceil(width / cell_px))), np.int64),
        float(cell_px),
    )


def fill_occlusion(
    model: OcclusionModel, camera: WorkCamera, ends_m: Floats, radii_m: Floats
) -> tuple[Floats, Floats]:
    """Fill the model with parts of ends (C,2,3) [m, world] and radii (C,2) [m]; the parts' quads (C,4,2) [work px],
    NaN where not before the camera, and the depths (C,2) of their ends [m]."""
    quads, depths = np.empty((len(ends_m), 4, 2)), np.empty((len(ends_m), 2))
    project_parts(ends_m, radii_m, camera, quads, depths)
    index_parts(quads, depths, model)
    return quads, depths
