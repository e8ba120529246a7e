"""Distances of the body's surface, measured by stereo matching between two neighbouring cameras."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from mocapd.body.arrays import camera_arrays
from mocapd.body.model import Shaped
from mocapd.body.surface import LEFT_LEG, RIGHT_LEG
from mocapd.each import Each, in_turn
from mocapd.fit.idmap_renderer import IdMapRenderer
from mocapd.fit.rays_in_other_kernels import (
    N_GROUPS,
    N_PARTS,
    distances_of_triangles,
    shown_on_rays,
    spread_over_groups,
)
from mocapd.fit.terms.distance_term import MeasuredDistances
from mocapd.fit.work_rays import rays_at, work_rays_in_world
from mocapd.geometry.camera_model import centre
from mocapd.types import Bytes, Camera, Ints
from mocapd.vision.ray_matching_kernels import PatchLabels, match_along_rays

_INSIDE = np.ones((3, 3), np.uint8)  # a part as drawn may be off by a work pixel
_EDGE_PX = 2  # work pixels from the body's edge: nearer, a patch holds more of what is behind


@dataclass(frozen=True, slots=True)
class StereoMatchParams:
    """How many points are matched, and which are accepted."""

    points: int = 20  # tried on each part and region of the body that shows
    leg_points: int = 20  # the same of legs, which have less texture
    reach_m: float = 0.4  # looked for so much nearer and farther than expected
    places: int = 19  # along the ray
    half_px: int = 6  # of a patch, in the pictures as delivered
    least_contrast: float = 4.0  # standard deviation of a patch, in grey values
    least_alike: float = 0.85
    sd_m: float = 0.04


def measured_distances(
    drawing: IdMapRenderer,
    drawn: tuple[Bytes, NDArray[np.int32]],
    body: Shaped,
    other: Camera,
    greys: tuple[Bytes, Bytes],
    turn: int,
    corner: tuple[int, int] = (0, 0),
    params: StereoMatchParams | None = None,
    each: Each = in_turn,
) -> MeasuredDistances:
    """Look for points of the body as expected in one camera (drawn: its ids and triangles (h,w) over the whole work
    picture, or a region of it that begins at `corner`, posed by `drawing`) in the other camera's picture.

    greys: both pictures as delivered; turn: a running number, by which other points are taken; each: of the halves of
    the points. Points without texture or with a poor match are left out.
    """
    p = params if params is not None else StereoMatchParams()
    m, posed = drawing.model, drawing.posed
    y, x = _samples(drawn, m.part, p, turn)
    triangle = drawn[1][y, x].astype(np.int64)
    camera, scale = drawing.camera, drawing.image_scale
    at_y, at_x = y + corner[1], x + corner[0]
    world_rays, origin = work_rays_in_world(camera, scale), centre(camera)
    pixels, along = rays_at(world_rays, at_y, at_x, scale)
    expected_m = np.empty(len(y))
    distances_of_triangles(
        triangle, m.triangle_bones, m.triangle_weights, body.centres, body.rest, posed.R, posed.joints, origin, along,
        expected_m,
    )  # fmt: skip
    offsets_m = np.linspace(-p.reach_m, p.reach_m, p.places)
    there = np.empty((len(y), p.places, 2))
    shown_on_rays(camera_arrays(other), origin, along, expected_m[:, None] + offsets_m, there)
    place, alike = np.empty(len(y)), np.empty(len(y))
    labels = _part_labels(drawn, m.part, corner, scale)

    def match(mine: slice) -> None:
        match_along_rays(
            *greys, pixels[mine], there[mine], p.half_px, p.least_contrast, p.places, 0.0, labels, place[mine], alike[mine]
        )  # fmt: skip

    half = len(y) // 2
    each(match, (slice(0, half), slice(half, None)))
    good = alike >= p.least_alike
    found_m = expected_m + (place / (p.places - 1) * 2.0 - 1.0) * p.reach_m
    return MeasuredDistances(
        triangle[good], origin, along[good], found_m[good], np.full(int(good.sum()), p.sd_m)
    )


def _part_labels(
    drawn: tuple[Bytes, NDArray[np.int32]],
    part: NDArray[np.uint8],
    corner: tuple[int, int],
    image_scale: int,
) -> PatchLabels:
    """The inside of each part of the body as drawn, away from its outline."""
    ids, triangles = drawn
    label = np.where(ids > 0, part[np.maximum(triangles, 0)] + np.uint8(1), np.uint8(0))
    label[cv2.erode(label, _INSIDE) != cv2.dilate(label, _INSIDE)] = 0
    return PatchLabels(label, *corner, image_scale)


def _samples(
    drawn: tuple[Bytes, NDArray[np.int32]],
    part: NDArray[np.uint8],
    params: StereoMatchParams,
    turn: int,
) -> tuple[Ints, Ints]:
    """Rows and columns of pixels inside of the drawing, as many of each part's regions."""
    points = np.full(N_PARTS, params.points)
    points[[LEFT_LEG, RIGHT_LEG]] = params.leg_points
    places = np.empty((int(points.sum()) * N_GROUPS // N_PARTS, 2), np.int64)
    n = spread_over_groups(*drawn, part, _EDGE_PX, points, turn, places)
    return places[:n, 0].copy(), places[:n, 1].copy()
