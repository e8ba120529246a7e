"""The rig for the page: cameras from above, their directions, places of the board, and the fit."""

from collections.abc import Mapping

import cv2
import numpy as np

from mocapd.calibrate.extrinsics.board_extrinsics import SceneExtrinsics, WorldExtrinsics
from mocapd.calibrate.extrinsics.visible_floor import CELL_M, LOWEST_M, rig_advice, visible_floor
from mocapd.calibration.board_spec import centre_m
from mocapd.errors import Problem
from mocapd.geometry.camera_model import camera_from_world, centre, project
from mocapd.types import Rig
from mocapd.wizard.step import Json, Shape


def plan_of(extrinsics: SceneExtrinsics, made: WorldExtrinsics) -> dict[str, Json]:
    """Metres in the world: x to the right of a person at rest facing +z is negative, see types.py."""
    scene = extrinsics.bundle.scene
    first = made.rig.cameras[0]
    # the scene's frame is the first camera's initial one; its present pose undoes its motion
    world_from_scene = camera_from_world(first).inverse() @ scene.camera_from_scene[0]
    boards = world_from_scene.apply(scene.scene_from_board.apply(centre_m(extrinsics.spec)))
    return {**plan_of_cameras(made.rig), "boards_m": np.round(boards, 3).tolist()}


def plan_of_cameras(rig: Rig) -> dict[str, Json]:
    """The cameras, and the floor on which two of them see a person: cells by their middle x, z [m]."""
    visible = visible_floor(rig)
    return {
        "cell_m": CELL_M,
        "seen_m": np.round(visible.cells_m, 2).tolist(),
        "size_m": [round(side, 1) for side in visible.size_m],
        "baseline_m": round(visible.baseline_m, 2),
        "angle_deg": round(visible.angle_deg) if np.isfinite(visible.angle_deg) else None,
        "cameras": [
            {
                "id": camera.name,
                "at_m": np.round(centre(camera), 3).tolist(),
                "towards": np.round(camera.R[2], 3).tolist(),
                "half_angle_rad": round(
                    float(np.arctan(0.5 * camera.size_px[0] / camera.K[0, 0])), 3
                ),
            }
            for camera in rig.cameras
        ],
    }


def advice_of(rig: Rig | None) -> tuple[Problem, ...]:
    return () if rig is None else tuple(rig_advice(visible_floor(rig), len(rig.cameras)))


def area_shapes(rig: Rig | None) -> Mapping[str, tuple[Shape, ...]]:
    """By camera the outline of the floor on which two cameras see a person whole, with its size; empty where there is
    none."""
    visible = None if rig is None else visible_floor(rig)
    if rig is None or visible is None or len(visible.cells_m) == 0:
        return {}
    # without the corners of cells, which no camera need see
    hull_m = cv2.convexHull(visible.cells_m.astype(np.float32))[:, 0]
    corners_m = np.stack([hull_m[:, 0], np.full(len(hull_m), LOWEST_M), hull_m[:, 1]], axis=1)
    middle_m = np.array([[*visible.cells_m.mean(axis=0)]])[:, [0, 0, 1]] * [1.0, 0.0, 1.0]
    text = f"{visible.size_m[0]:.1f} x {visible.size_m[1]:.1f} m"
    shapes: dict[str, tuple[Shape, ...]] = {}
    for camera in rig.cameras:
        at_px, (middle_px,) = project(camera, corners_m), project(camera, middle_m)
        if np.isfinite(at_px).all() and np.isfinite(middle_px).all():
            outline = tuple((float(x), float(y)) for x, y in at_px)
            place = ((float(middle_px[0]), float(middle_px[1])),)
            shapes[camera.name] = (Shape("polygon", outline), Shape("text", place, text=text))
    return shapes


def quality_of(made: WorldExtrinsics) -> dict[str, Json]:
    return {
        "rms_px": round(made.rms_px, 3),
        "play_area_cm": round(made.play_area.median_cm, 2) if made.play_area else None,
        "cameras": {name: {"rms_px": round(fit.rms_px, 3)} for name, fit in made.cameras.items()},
    }
