"""Solves each camera's light from strokes on frozen pictures, with a preview of the tracker's segmentation."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mocapd.calibrate.colours.colour_solution import personal_colour_model
from mocapd.calibrate.colours.lookalikes import (
    Lookalike,
    colours_alone,
    hull_of,
    lookalike_warning,
    lookalikes,
)
from mocapd.calibrate.colours.stroke_check import StrokeProblem, check_strokes
from mocapd.shirt.colour.colour_model import MIN_PIXELS, ColourModel
from mocapd.shirt.colour.from_pictures import colour_model, white_balances
from mocapd.shirt.colour.strokes import COLOURS, stroke_means
from mocapd.types import Bytes, Floats, LabelledPicture
from mocapd.wizard.colour.stroke_images import encode_preview

_SEEN_WIDTH_PX = 640  # of the picture "as the tracker sees it"


@dataclass(frozen=True, slots=True, eq=False)
class StrokeDrawing:
    """A frozen picture with the strokes on it; shirt (h,w): non-zero on the body of the proposal, None without
    one."""

    picture: LabelledPicture
    shirt: Bytes | None = None


@dataclass(frozen=True, slots=True, eq=False)
class CameraSolution:
    """The solution of one camera's strokes `drawn`.

    W (3,3): None when the strokes are not good enough, and `problems` say why; preview: a PNG of the pixels that read as
    the shirt, None without W; alike: other things in the picture with its colours, and `note` says so.
    """

    drawn: StrokeDrawing
    problems: tuple[StrokeProblem, ...]
    W: Floats | None = None
    preview: bytes | None = None
    alike: tuple[Lookalike, ...] = ()
    note: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """cameras: by camera; missing: names of the colours that a personal model lacks; personal: whether there is
    one."""

    cameras: Mapping[str, CameraSolution]
    personal: bool
    missing: tuple[str, ...]


def solve_colours(
    drawn: Mapping[str, StrokeDrawing], personal: bool, before: Mapping[str, CameraSolution]
) -> Solution:
    """Solve all cameras that have strokes; `before`: solutions with strokes that need no second check.

    personal: use the wearer's own colours, when every colour has strokes in some camera.
    """
    standard = colour_model(())
    judged = {
        name: before[name].problems
        if name in before and before[name].drawn is drawing
        else check_strokes(drawing.picture.pixels, drawing.picture.labels, standard)
        for name, drawing in drawn.items()
        if drawing.picture.labels.any()
    }
    good = {
        name: drawn[name].picture
        for name, problems in judged.items()
        if not any(problem.serious for problem in problems)
    }
    W = white_balances(good, standard)
    missing = _missing(good, standard)
    model = standard
    if personal and good and not missing:
        model = personal_colour_model(good, standard)
    out = {}
    for name, problems in judged.items():
        out[name] = CameraSolution(drawn[name], problems)
        if name in W:
            out[name] = _solution(drawn[name], problems, model, W[name])
    return Solution(out, personal and bool(good) and not missing, missing)


def _solution(
    drawn: StrokeDrawing, problems: tuple[StrokeProblem, ...], model: ColourModel, W: Floats
) -> CameraSolution:
    shirt = drawn.shirt if drawn.shirt is not None else hull_of(drawn.picture.labels)
    pixels = drawn.picture.pixels
    alike = lookalikes(pixels, shirt, model, W)
    h, w = pixels.shape[:2]
    step = -(-w // _SEEN_WIDTH_PX)
    small = np.ascontiguousarray(pixels[::step, ::step])
    return CameraSolution(
        drawn, problems, W, encode_preview(small, colours_alone(small, model, W)),
        alike, lookalike_warning(alike, (w, h)),
    )  # fmt: skip


def _missing(pictures: Mapping[str, LabelledPicture], model: ColourModel) -> tuple[str, ...]:
    """Names of the colours with too few strokes in all cameras together."""
    pixels = np.zeros(COLOURS)
    for picture in pictures.values():
        pixels += stroke_means(picture.pixels, picture.labels)[1]
    return tuple(model.names[k] for k in range(COLOURS) if pixels[k] < MIN_PIXELS)
