"""Stereo depth of a person between two neighbouring cameras, where both see the same texture.

With a small baseline outlines and colours hardly show depth order; this alone finds hands in front of a trunk of the
same colour.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.body.areas import N_AREAS
from mocapd.body.arrays import camera_arrays
from mocapd.each import Each, in_turn
from mocapd.fit.fit_params import FitParams
from mocapd.fit.idmap_renderer import IdMapRenderer, Roi
from mocapd.fit.rays_in_other_kernels import evenly_between, shown_on_rays
from mocapd.fit.terms.depth_agreement_kernels import compare_depths
from mocapd.fit.view import View
from mocapd.fit.work_rays import rays_at, work_rays_in_world
from mocapd.geometry.camera_model import centre
from mocapd.types import Bytes, Camera, Floats, Ints
from mocapd.vision.ray_matching_kernels import EVERYWHERE, match_along_rays

GRID_PX = 3  # the middle one of so many work pixels each way is looked for
_NEAREST_M = 0.3
_APART = 2  # places: as near to the best one all are nearly as good


@dataclass(frozen=True, slots=True)
class StereoDepthParams:
    """Search range of a point's depth, and when a match is accepted."""

    nearer_m: float = 0.9  # than the hips: an arm and half a trunk
    farther_m: float = 0.5
    place_px: float = 1.0  # from one place along a ray to the next, in the other camera
    half_px: int = 5  # of a patch, in the pictures as delivered
    least_contrast: float = 4.0  # standard deviation of a patch, in grey values
    least_alike: float = 0.85
    least_ahead: float = 0.03  # of all other places: stripes along a ray are alike everywhere
    # pixels outside the body, and so much farther than its hips, are room; the search range of those
    behind_m: float = 0.7
    room_m: float = 4.0


@dataclass(frozen=True, slots=True, eq=False)
class StereoPair:
    """A camera and its neighbour, with their pictures in grey as delivered; image_scale: by how much the camera's are
    averaged down to work pictures."""

    camera: Camera
    other: Camera
    greys: tuple[Bytes, Bytes]
    image_scale: int


def grid_rays(
    camera: Camera, image_scale: int, roi: Roi, y: Ints, x: Ints
) -> tuple[Floats, Floats]:
    """Pixels as delivered (N,2), and unit directions (N,3) in the world, of places (N,) in the grid over a region."""
    y, x = (n * GRID_PX + GRID_PX // 2 + corner for n, corner in ((y, roi[1]), (x, roi[0])))
    return rays_at(work_rays_in_world(camera, image_scale), y, x, image_scale)


def stereo_depth_m(
    wanted: NDArray[np.bool_],
    roi: Roi,
    pair: StereoPair,
    root_m: Floats,
    farther_m: float,
    params: StereoDepthParams,
    each: Each = in_turn,
) -> NDArray[np.float32]:
    """Along the camera's axis (h,w) [m], of where it is wanted (h,w) and near root_m (3,), no more than farther_m
    behind it; NaN elsewhere, and where no texture tells.

    roi: of what is wanted, in work pixels. Alike over squares of GRID_PX. each: of the halves of the points.
    """
    p, camera = params, pair.camera
    depth_m = np.full(wanted.shape, np.nan, np.float32)
    on_grid = wanted[::GRID_PX, ::GRID_PX]
    y, x = np.nonzero(on_grid)
    if not len(y):
        return depth_m
    pixels, along = grid_rays(camera, pair.image_scale, roi, y, x)
    origin = centre(camera)
    away_m = float(np.linalg.norm(root_m - origin))
    near_m, far_m = max(away_m - p.nearer_m, _NEAREST_M), away_m + farther_m
    ends = np.empty((len(y), 2, 2))
    shown_on_rays(
        camera_arrays(pair.other), origin, along, np.tile([near_m, far_m], (len(y), 1)), ends
    )
    nearest, farthest = ends[:, 0], ends[:, 1]
    length_px = np.linalg.norm(nearest - farthest, axis=1).max(
        initial=0.0, where=~np.isnan(nearest[:, 0])
    )
    places = int(length_px / p.place_px) + 3
    there = np.empty((len(y), places, 2))
    evenly_between(farthest, nearest, there)
    place, alike = np.empty(len(y)), np.empty(len(y))

    def match(mine: slice) -> None:
        match_along_rays(
            *pair.greys, pixels[mine], there[mine], p.half_px, p.least_contrast, _APART, p.least_ahead,
            EVERYWHERE, place[mine], alike[mine],
        )  # fmt: skip

    each(match, (slice(0, len(y) // 2), slice(len(y) // 2, None)))
    # places that are even in the picture are so in the inverse of the distance
    share = place / (places - 1)
    found_m = 1.0 / ((1.0 - share) / far_m + share / near_m)
    found_m = np.where(alike >= p.least_alike, found_m * (along @ camera.R[2]), np.nan)
    coarse = np.full(on_grid.shape, np.nan, np.float32)
    coarse[y, x] = found_m
    h, w = wanted.shape
    depth_m[:] = coarse.repeat(GRID_PX, axis=0).repeat(GRID_PX, axis=1)[:h, :w]
    return depth_m


def compared_depths(
    drawings: Sequence[IdMapRenderer], views: Sequence[View], p: FitParams
) -> tuple[float, Floats, float]:
    """The cost of last drawn pixels off the stereo depth; the agreement by area (A,); and the number of pixels with an
    object well in front of the drawn body."""
    if all(view.depth_m is None for view in views):
        return 0.0, np.ones(N_AREAS), 0.0
    cost = nearer_px = 0.0
    asked, off = np.zeros(N_AREAS), np.zeros(N_AREAS)
    for view in views:
        if view.depth_m is not None:
            drawing = drawings[view.index]
            away, nearer = compare_depths(
                drawing.last_depth_m(view.roi), drawing.last(view.roi)[1], drawing.labels.area, view.depth_m, GRID_PX,
                p.depth_around_px, p.depth_off_m, asked, off,
            )  # fmt: skip
            cost += p.depth_cost * away
            nearer_px += nearer
    share = np.minimum(p.depth_usual * (1.0 - off / np.maximum(asked, 1.0)), 1.0)
    return cost, np.where(asked >= p.depth_least_px, share, 1.0), nearer_px
