"""Proposes strokes on a frozen picture: the patch interiors of the fitted body."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import cv2
import numpy as np

from mocapd.calibrate.colours.light_reading import MEAN_STATURE_M, LightReader, MapCameras
from mocapd.calibrate.colours.light_refinement import Reading
from mocapd.shirt.colour.colour_model import ColourModel
from mocapd.shirt.colour.strokes import COLOURS, stroke_means
from mocapd.shirt.colour.white_balance import shade_precision, solve_white_balance
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.types import Bytes, Floats, Rig

_CONFIRMED = 0.4  # share of a rendered patch that the picture confirms, for it to get strokes
_LEAST_PX = 4  # work px of a stroke; less is a speck
_SPREAD_OF_MEDIAN = 1.4826  # standard deviation of a normal distribution in its median deviations
_LEAST_SPREAD = 0.008  # of r, g, b as shares of their sum: a camera's noise
_FAR = 4.0  # standard deviations at which a pixel is of another thing


@dataclass(frozen=True, slots=True, eq=False)
class Proposal:
    """strokes (H,W): 0 nothing, 1..10 colour id; W (3,3) solved from them, model_from_camera on RGB 0..1; shirt (H,W):
    colour ids of the fitted body, for the preview."""

    strokes: Bytes
    W: Floats
    shirt: Bytes


def propose_strokes(
    pictures: Mapping[str, Bytes],
    rig: Rig,
    model: ColourModel,
    database: PoseDatabase,
    stature_m: float = MEAN_STATURE_M,
    progress: Callable[[float], None] = lambda _: None,
    map_cameras: MapCameras = map,
) -> dict[str, Proposal]:
    """Strokes for simultaneous pictures (H,W,3) BGR of a person in the shirt, by camera name; of a single camera only
    the intrinsics matter.

    progress: 0..1; map_cameras: `map`, or that of a pool of threads, one for each camera at best.
    The result lacks cameras without a person. Raises InputError when that is all of them.
    """
    reader = LightReader(rig.cameras, model, database, stature_m)
    chosen = {i: pictures[name] for i, name in enumerate(rig.names) if name in pictures}
    readings = reader.read_together(chosen, progress, map_cameras)
    return {
        rig.names[i]: _proposal(reader, i, chosen[i], reading, model)
        for i, reading in readings.items()
    }


def interiors(rendered: Bytes, classified: Bytes) -> Bytes:
    """Strokes (h,w): where body and picture agree on a colour, off the borders of its patches.

    rendered, classified (h,w) colour ids. A patch gets none where the picture contradicts most of it.
    """
    out = np.zeros_like(rendered)
    cross = cv2.getStructuringElement(cv2.MORPH_CROSS, (3, 3))
    for colour in range(1, COLOURS + 1):
        count, patches = cv2.connectedComponents((rendered == colour).astype(np.uint8))
        for patch in range(1, count):
            expected = (patches == patch).astype(np.uint8)
            agreed = expected & (classified == colour)
            if agreed.sum() < _CONFIRMED * expected.sum():
                continue
            inside = cv2.erode(expected, cross) & cv2.medianBlur(agreed, 3) & agreed
            _, parts, stats, _ = cv2.connectedComponentsWithStats(inside, connectivity=4)
            large = np.flatnonzero(stats[:, cv2.CC_STAT_AREA] >= _LEAST_PX)
            out[np.isin(parts, large[large > 0])] = colour
    return out


def of_one_dye(strokes: Bytes, pixels: Bytes) -> Bytes:
    """The strokes (H,W) without pixels whose hue differs from most of their part: a wall of nearly the same colour
    next to a sleeve widens the colour's model until it matches sleeves everywhere.

    Shade keeps the hue, so r, g, b are compared as shares of their sum; pixels (H,W,3) BGR.
    """
    out = np.zeros_like(strokes)
    for colour in range(1, COLOURS + 1):
        count, parts = cv2.connectedComponents((strokes == colour).astype(np.uint8))
        for part in range(1, count):
            rows, columns = np.nonzero(parts == part)
            bgr = pixels[rows, columns].astype(np.float64) + 1.0
            share = bgr / bgr.sum(axis=1, keepdims=True)
            apart = np.abs(share - np.median(share, axis=0))
            spread = np.maximum(_SPREAD_OF_MEDIAN * np.median(apart, axis=0), _LEAST_SPREAD)
            of_dye = (apart < _FAR * spread).all(axis=1)
            out[rows[of_dye], columns[of_dye]] = colour
    return out


def _proposal(
    reader: LightReader, index: int, pixels: Bytes, reading: Reading, model: ColourModel
) -> Proposal:
    drawing, view = reader.drawings[index], reading.view
    rendered = drawing.render(reading.fit.state, view.dt_s, view.roi)
    at = (view.roi[0] * drawing.image_scale, view.roi[1] * drawing.image_scale)
    inside = _upscale(interiors(rendered, view.ids), drawing.image_scale, at, pixels)
    strokes = of_one_dye(inside, pixels)
    means, counts = stroke_means(pixels, strokes)
    W = solve_white_balance(means, model.mean, counts, precision=shade_precision(model))
    return Proposal(strokes, W, _upscale(rendered, drawing.image_scale, at, pixels))


def _upscale(ids: Bytes, image_scale: int, at: tuple[int, int], pixels: Bytes) -> Bytes:
    """Ids of a region of the work picture (h,w) in the picture's own pixels (H,W)."""
    out = np.zeros(pixels.shape[:2], np.uint8)
    large = np.repeat(np.repeat(ids, image_scale, axis=0), image_scale, axis=1)
    out[at[1] : at[1] + large.shape[0], at[0] : at[0] + large.shape[1]] = large
    return out
