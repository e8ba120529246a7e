"""The tracked body as lines over a camera's picture."""

import numpy as np

from mocapd.geometry.camera_model import project
from mocapd.types import BodyState, Camera, Skeleton
from mocapd.wizard.step import Shape

SURE = 0.35  # a joint of less confidence is drawn as a guess


def bone_shapes(camera: Camera, body: BodyState, skeleton: Skeleton) -> tuple[Shape, ...]:
    """A line for each bone in pixels of the camera's frame; nothing without a pose, and no bone of
    which an end is behind the camera."""
    if body.joints_m is None:
        return ()
    at_px = project(camera, body.joints_m)
    # lists: this is drawn over every picture of the live view, and numpy is slow at single numbers
    seen: list[bool] = np.asarray(np.isfinite(at_px).all(axis=1)).tolist()
    points = [(x, y) for x, y in at_px.tolist()]
    sure: list[bool] = (body.confidence >= SURE).tolist()
    return tuple(
        Shape("line", (points[parent], points[child]), "bone" if sure[child] else "hint")
        for child, parent in enumerate(skeleton.parents.tolist())
        if parent >= 0 and seen[parent] and seen[child]
    )
