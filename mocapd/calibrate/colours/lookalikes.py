"""Finds things in the background with the shirt's colours, and names them so that the user can move them."""

from dataclasses import dataclass

import cv2
import numpy as np

from mocapd.shirt.colour.colour_model import ColourModel
from mocapd.shirt.colour.colour_tables import colour_table
from mocapd.shirt.colour.lut_kernels import classify_by_table
from mocapd.shirt.segmentation.segmentation_params import SegmentationParams
from mocapd.types import Bytes, Floats, Ints

_LEAST_SHARE = 0.001  # of the picture: about half of a cuff across a room
_BODY_MARGIN_SHARE = 0.04  # of the picture's width around the wearer: hands, edges, motion
_CORNER_SHARE = 0.01  # of a polygon's circumference: how far it may be from the outline
_EVERYWHERE = np.ones((1, 1), np.uint8)  # "no mask" of the table kernel


@dataclass(frozen=True, slots=True, eq=False)
class Lookalike:
    """A region that reads as the colour `name`: polygon (N,2) [px] and its area."""

    name: str
    polygon_px: Ints
    area_px: int


def lookalikes(pixels: Bytes, shirt: Bytes, model: ColourModel, W: Floats) -> tuple[Lookalike, ...]:
    """Regions of a picture (H,W,3) BGR outside the wearer that read as a colour of the shirt, largest first.

    shirt (H,W): non-zero on the shirt: `Proposal.shirt`, or `hull_of` strokes that cover it. W (3,3): white balance.
    Colours are read as by `colours_alone`.
    """
    h, w = pixels.shape[:2]
    ids = colours_alone(pixels, model, W)
    size = 2 * round(_BODY_MARGIN_SHARE * w) + 1
    near = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size))
    ids[cv2.dilate((shirt > 0).astype(np.uint8), near) > 0] = 0
    regions = [
        Lookalike(model.names[colour - 1], polygon, area)
        for colour in range(1, len(model.names) + 1)
        for polygon, area in _regions((ids == colour).astype(np.uint8), _LEAST_SHARE * h * w)
    ]
    return tuple(sorted(regions, key=lambda lookalike: -lookalike.area_px))


def colours_alone(pixels: Bytes, model: ColourModel, W: Floats) -> Bytes:
    """Colour ids (H,W) of a picture (H,W,3) BGR as the tracker classifies them without a pose (paper section
    5.2, step 1)."""
    p = SegmentationParams()
    table = colour_table(model.tolerating(p.shading_sd, p.cloth_sd), W, p.first_threshold)
    ids = np.empty(pixels.shape[:2], np.uint8)
    classify_by_table(np.ascontiguousarray(pixels), _EVERYWHERE, 31, table, 0, 0, 1, ids)
    return ids


def hull_of(strokes: Bytes) -> Bytes:
    """The convex hull (H,W) 0/1 of strokes (H,W): the area between strokes belongs to the wearer."""
    points = cv2.findNonZero((strokes > 0).astype(np.uint8))
    mask = np.zeros(strokes.shape, np.uint8)
    if points is not None:
        cv2.fillConvexPoly(mask, cv2.convexHull(points), 1)
    return mask


def lookalike_warning(regions: tuple[Lookalike, ...], size_px: tuple[int, int]) -> str:
    """One sentence for the user, or "" for no lookalikes; size_px: width and height."""
    if not regions:
        return ""
    places = [
        f"{lookalike.name} ({_place(lookalike.polygon_px, size_px)})" for lookalike in regions[:5]
    ]
    more = f" and {len(regions) - 5} smaller ones" if len(regions) > 5 else ""
    return (
        f"these things behind you have the shirt's colours: {', '.join(places)}{more}"
        " -- cover them or turn the camera"
    )


def _regions(mask: Bytes, least_px: float) -> list[tuple[Ints, int]]:
    closed = cv2.morphologyEx(mask, cv2.MORPH_CLOSE, np.ones((5, 5), np.uint8))
    solid = cv2.morphologyEx(closed, cv2.MORPH_OPEN, np.ones((5, 5), np.uint8))
    outlines, _ = cv2.findContours(solid, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    out = []
    for outline in outlines:
        filled = cv2.drawContours(np.zeros_like(mask), [outline], -1, 1, cv2.FILLED)
        area = int(mask[filled > 0].sum())
        if area >= least_px:
            corners = cv2.approxPolyDP(outline, _CORNER_SHARE * cv2.arcLength(outline, True), True)
            out.append((corners[:, 0].astype(np.int64), area))
    return out


def _place(polygon_px: Ints, size_px: tuple[int, int]) -> str:
    x, y = polygon_px.mean(axis=0) / np.array(size_px)
    height = "top" if y < 1 / 3 else "bottom" if y > 2 / 3 else "middle"
    side = "left" if x < 1 / 3 else "right" if x > 2 / 3 else "centre"
    return f"{height} {side}"
