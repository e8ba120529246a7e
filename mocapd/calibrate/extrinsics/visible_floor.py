"""The area of floor on which cameras see a whole person, and advice on improving the rig."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mocapd.errors import Problem
from mocapd.geometry.camera_model import centre, project, to_camera
from mocapd.types import Camera, Floats, Rig

Bools = NDArray[np.bool_]

CELL_M = 0.2
_REACH_M = 5.0  # examined distance from the world's origin, each way
LOWEST_M = 0.05  # of a person, above the floor
_HEIGHTS_M = (LOWEST_M, 1.0, 1.85)  # of a person who stands
_FARTHEST_M = 6.0  # beyond, a person is too small in the picture of a usual webcam
_FOLD_MARGIN = 0.25  # largest shift of a point by lens distortion
SMALL_M2 = 2.0
NARROW_DEG, WIDE_DEG = 20.0, 150.0


@dataclass(frozen=True, slots=True, eq=False)
class VisibleFloor:
    """cells_m: (N,2) x, z of the middle of each cell of CELL_M in which two cameras see a person whole, or the only
    camera does [m]; size_m: of these cells along x and z [m]; baseline_m: longest distance between two cameras [m], 0 of
    one; angle_deg: between the rays of that pair to the middle of the cells [deg], NaN without cells."""

    cells_m: Floats
    size_m: tuple[float, float]
    baseline_m: float
    angle_deg: float

    @property
    def area_m2(self) -> float:
        return len(self.cells_m) * CELL_M**2


def visible_floor(rig: Rig) -> VisibleFloor:
    """The visible floor of a rig whose floor is y = 0."""
    edge_m = np.arange(-_REACH_M + 0.5 * CELL_M, _REACH_M, CELL_M)
    x_m, z_m = (grid_m.ravel() for grid_m in np.meshgrid(edge_m, edge_m, indexing="ij"))
    visible = np.zeros(len(x_m), dtype=int)
    for camera in rig.cameras:
        whole = np.ones(len(x_m), dtype=bool)
        for height_m in _HEIGHTS_M:
            points_m = np.stack([x_m, np.full_like(x_m, height_m), z_m], axis=1)
            depth_m = to_camera(camera, points_m)[:, 2]
            # distortion may fold a distant point back into the picture
            inside = _in_picture(camera, project(camera, points_m), 0.0)
            near = _in_picture(
                camera, project(replace(camera, dist=np.zeros(5)), points_m), _FOLD_MARGIN
            )
            whole &= inside & near & (depth_m > 0.3) & (depth_m < _FARTHEST_M)
        visible += whole
    cells = visible >= min(2, len(rig.cameras))
    cells_m = np.stack([x_m[cells], z_m[cells]], axis=1)
    size_m = (0.0, 0.0)
    if len(cells_m):
        across = np.ptp(cells_m, axis=0) + CELL_M
        size_m = float(across[0]), float(across[1])
    baseline_m, angle_deg = _widest_pair(rig, cells_m)
    return VisibleFloor(cells_m, size_m, baseline_m, angle_deg)


def rig_advice(visible: VisibleFloor, cameras: int) -> Iterator[Problem]:
    """Improvements of the rig; empty for a good one."""
    by = "both cameras" if cameras == 2 else "two cameras" if cameras > 2 else "the camera"
    if visible.area_m2 < SMALL_M2:
        turn = ", or turn them towards the same place" if cameras > 1 else ""
        see = "see" if cameras > 1 else "sees"
        size = f"on {visible.area_m2:.1f} square metres of the floor only"
        yield Problem(
            f"{by} {see} a person whole {size if len(visible.cells_m) else 'nowhere on the floor'}",
            "the play area",
            f"move the cameras back to 2.5 to 3.5 m from its middle{turn}, and do this step again",
        )
    if cameras > 1 and visible.angle_deg < NARROW_DEG:
        yield Problem(
            f"the cameras look from nearly the same side: {visible.baseline_m:.1f} m apart, "
            f"{visible.angle_deg:.0f} degrees",
            "depth",
            "put them 1.5 to 3 m apart, and do this step again",
        )
    elif cameras == 2 and visible.angle_deg > WIDE_DEG:
        yield Problem(
            f"the cameras face each other ({visible.angle_deg:.0f} degrees): what one sees the other does not",
            "overlap",
            "move them to the same half of the room, 60 to 100 degrees apart, and do this step again",
        )


def _in_picture(camera: Camera, at_px: Floats, margin: float) -> Bools:
    """(N,) of (N,2); margin: how far a point may be outside, as a share of the picture."""
    size_px = np.array(camera.size_px, dtype=float)
    low, high = at_px >= -margin * size_px, at_px < (1.0 + margin) * size_px
    return np.asarray(np.all(low & high, axis=1), dtype=np.bool_)


def _widest_pair(rig: Rig, cells_m: Floats) -> tuple[float, float]:
    centres_m = [centre(camera) for camera in rig.cameras]
    pairs = [(a, b) for i, a in enumerate(centres_m) for b in centres_m[i + 1 :]]
    if not pairs:
        return 0.0, float("nan")
    a, b = max(pairs, key=lambda pair: float(np.linalg.norm(pair[0] - pair[1])))
    baseline_m = float(np.linalg.norm(a - b))
    if not len(cells_m):
        return baseline_m, float("nan")
    x_m, z_m = cells_m.mean(axis=0)
    rays = [centre_m - np.array([x_m, 1.0, z_m]) for centre_m in (a, b)]
    cosine = rays[0] @ rays[1] / (np.linalg.norm(rays[0]) * np.linalg.norm(rays[1]))
    return baseline_m, float(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))
