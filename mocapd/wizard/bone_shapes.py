"""The tracked body as lines over a camera's picture, with its uncertainty as a halo around them."""

import numpy as np

from mocapd.geometry.camera_model import project, to_camera
from mocapd.types import BodyState, Camera, Floats, Skeleton
from mocapd.wizard.step import Shape

SURE = 0.35  # a joint of less confidence is drawn as a guess; one without confidence is not drawn
_SHOWN = 0.005  # as the page of the live view, which has two digits of a confidence
_WIDEST_M = 0.3  # of a halo: a wider one would add no information


def bone_shapes(camera: Camera, body: BodyState, skeleton: Skeleton) -> tuple[Shape, ...]:
    """A line for each bone in pixels of the camera's frame, above halos of one standard deviation. Empty without a pose;
    omits bones with an end behind the camera, or with neither confidence nor uncertainty."""
    if body.joints_m is None:
        return ()
    at_px = project(camera, body.joints_m)
    # lists: this runs for every picture of the live view, and numpy is slow at single numbers
    is_estimated = (body.confidence > _SHOWN) | np.isfinite(body.uncertainty_m)
    drawn: list[bool] = (np.isfinite(at_px).all(axis=1) & is_estimated).tolist()
    points = [(x, y) for x, y in at_px.tolist()]
    styles = ["bone" if sure else "hint" for sure in (body.confidence >= SURE).tolist()]
    bones = [
        (parent, child)
        for child, parent in enumerate(skeleton.parents.tolist())
        if parent >= 0 and drawn[parent] and drawn[child]
    ]
    radii_px: list[float] = _radii_px(camera, body.joints_m, body.uncertainty_m).tolist()
    halos = []
    for style in ("hint", "bone"):
        ends = [end for bone in bones if styles[bone[1]] == style for end in bone]
        if any(radii_px[end] for end in ends):
            at = tuple(points[end] for end in ends)
            halos.append(Shape("halo", at, style, radii_px=tuple(radii_px[end] for end in ends)))
    lines = (
        Shape("line", (points[parent], points[child]), styles[child]) for parent, child in bones
    )
    return (*halos, *lines)


def _radii_px(camera: Camera, joints_m: Floats, uncertainty_m: Floats) -> Floats:
    """(J,) of the uncertainty at the joint's distance; 0 where it is infinite."""
    bounded_m = np.where(np.isfinite(uncertainty_m), np.minimum(uncertainty_m, _WIDEST_M), 0.0)
    depth_m = np.maximum(to_camera(camera, joints_m)[:, 2], 1e-3)
    radii: Floats = bounded_m * camera.K[0, 0] / depth_m
    return radii
