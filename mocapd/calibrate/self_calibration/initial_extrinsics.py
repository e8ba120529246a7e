"""Initial extrinsics from the wearer: each camera placed relative to one with observations of the same bodies."""

from collections.abc import Sequence

import numpy as np

from mocapd.calibrate.self_calibration.patch_tracks import MARKS, PatchObservation, place_nominally
from mocapd.calibrate.self_calibration.relative_pose import relative_pose
from mocapd.errors import ConfigError
from mocapd.geometry.camera_model import camera_from_world, with_extrinsics
from mocapd.types import Camera


def initial_extrinsics(
    observations: Sequence[PatchObservation], bare_cameras: Sequence[Camera]
) -> list[Camera]:
    """The first camera at the nominal pose of a single webcam, the others by common bodies.

    Cameras without bodies in common with the first are chained through others. Raises ConfigError naming a
    camera that has none in common with any.
    """
    alone = place_nominally(bare_cameras)
    placed: dict[str, Camera] = {alone[0].name: alone[0]}
    while len(placed) < len(alone):
        candidates = [
            ([m for m in observations if a in m and b.name in m], a, b)
            for a in placed
            for b in alone
            if b.name not in placed
        ]
        shared, old, new = max(candidates, key=lambda entry: len(entry[0]))
        first = [m[old] for m in shared]
        second = [m[new.name] for m in shared]
        if not shared:
            raise ConfigError(
                "never saw the wearer together with another camera",
                f"camera {new.name!r}",
                "walk where both see the shirt, or turn the camera",
            )
        weights = np.array(
            [
                np.minimum(a.confidence[MARKS], b.confidence[MARKS])
                for a, b in zip(first, second, strict=True)
            ]
        )
        new_from_old = relative_pose(
            np.concatenate([s.joints_m[MARKS] for s in first]),
            np.concatenate([s.joints_m[MARKS] for s in second]),
            weights.ravel(),
        )
        placed[new.name] = with_extrinsics(new, new_from_old @ camera_from_world(placed[old]))
    return [placed[camera.name] for camera in alone]
