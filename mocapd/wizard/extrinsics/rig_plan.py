"""The rig for the page: from above, cameras, where they look and where the board was; how well it fits."""

import numpy as np

from mocapd.calibrate.extrinsics.board_extrinsics import SceneExtrinsics, WorldExtrinsics
from mocapd.calibrate.extrinsics.seen_floor import CELL_M, rig_advice, seen_floor
from mocapd.calibration.board_spec import centre_m
from mocapd.errors import Problem
from mocapd.geometry.camera_model import camera_from_world, centre
from mocapd.types import Rig
from mocapd.wizard.step import Json


def plan_of(extrinsics: SceneExtrinsics, made: WorldExtrinsics) -> dict[str, Json]:
    """Metres in the world: x to the right of a person at rest facing +z is negative, see types.py."""
    scene = extrinsics.bundle.scene
    first = made.rig.cameras[0]
    # the scene's frame is the first camera's as it was at first; its own pose undoes what moved it
    world_from_scene = camera_from_world(first).inverse() @ scene.camera_from_scene[0]
    boards = world_from_scene.apply(scene.scene_from_board.apply(centre_m(extrinsics.spec)))
    return {**plan_of_cameras(made.rig), "boards_m": np.round(boards, 3).tolist()}


def plan_of_cameras(rig: Rig) -> dict[str, Json]:
    """The cameras, and the floor that two of them see a person on: cells by their middle x, z [m]."""
    seen = seen_floor(rig)
    return {
        "cell_m": CELL_M,
        "seen_m": np.round(seen.cells_m, 2).tolist(),
        "size_m": [round(one, 1) for one in seen.size_m],
        "area_m2": round(seen.area_m2, 1),
        "baseline_m": round(seen.baseline_m, 2),
        "angle_deg": round(seen.angle_deg) if np.isfinite(seen.angle_deg) else None,
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
    """What would make the rig better."""
    return () if rig is None else rig_advice(seen_floor(rig), len(rig.cameras))


def quality_of(made: WorldExtrinsics) -> dict[str, Json]:
    """How well the cameras fit each other."""
    return {
        "rms_px": round(made.rms_px, 3),
        "play_area_cm": round(made.play_area.median_cm, 2) if made.play_area else None,
        "cameras": {
            name: {
                "rms_px": round(fit.rms_px, 3),
                "views": fit.views,
                "focal_percent": round(100.0 * fit.focal_deviation, 2),
            }
            for name, fit in made.cameras.items()
        },
        "positions": made.positions,
    }
