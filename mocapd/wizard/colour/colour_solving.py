"""From strokes on frozen pictures to each camera's light, and to what the tracker then sees."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mocapd.calibrate.colours.colour_solution import personal_colour_model
from mocapd.calibrate.colours.lookalikes import (
    Lookalike,
    colours_alone,
    described,
    hull_of,
    lookalikes,
)
from mocapd.calibrate.colours.stroke_check import StrokeProblem, check_strokes
from mocapd.shirt.colour.colour_model import MIN_PIXELS, ColourModel
from mocapd.shirt.colour.from_pictures import colour_model, white_balances
from mocapd.shirt.colour.strokes import COLOURS, stroke_means
from mocapd.types import Bytes, Floats, LabelledPicture
from mocapd.wizard.colour.stroke_images import encode_seen

_SEEN_WIDTH_PX = 640  # of the picture "as the tracker sees it"


@dataclass(frozen=True, slots=True, eq=False)
class StrokeDrawing:
    """A frozen picture with the strokes on it; shirt (h,w): non-zero on the body that they were proposed
    from, None when it is not known."""

    picture: LabelledPicture
    shirt: Bytes | None = None


@dataclass(frozen=True, slots=True, eq=False)
class CameraSolution:
    """What one camera's strokes come to. `drawn` is what it is the solution of.

    W (3,3): None when the strokes are not good enough, and `problems` say why; seen: a PNG of what is
    read as the shirt, None without W; alike: what else in the picture has its colours, and `note`
    says so.
    """

    drawn: StrokeDrawing
    problems: tuple[StrokeProblem, ...]
    W: Floats | None = None
    seen: bytes | None = None
    alike: tuple[Lookalike, ...] = ()
    note: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """By camera; missing: names of the colours without which there is no personal model; personal:
    whether one was used."""

    cameras: Mapping[str, CameraSolution]
    personal: bool
    missing: tuple[str, ...]


def solve_colours(
    drawn: Mapping[str, StrokeDrawing], personal: bool, before: Mapping[str, CameraSolution]
) -> Solution:
    """Solve all cameras that have strokes; `before`: solutions whose strokes need not be judged again.

    personal: use the wearer's own colours, when every colour has strokes in some camera.
    """
    standard = colour_model(())
    judged = {
        name: before[name].problems
        if name in before and before[name].drawn is one
        else check_strokes(one.picture.pixels, one.picture.labels, standard)
        for name, one in drawn.items()
        if one.picture.labels.any()
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
            out[name] = _seen(drawn[name], problems, model, W[name])
    return Solution(out, personal and bool(good) and not missing, missing)


def _seen(
    drawn: StrokeDrawing, problems: tuple[StrokeProblem, ...], model: ColourModel, W: Floats
) -> CameraSolution:
    shirt = drawn.shirt if drawn.shirt is not None else hull_of(drawn.picture.labels)
    pixels = drawn.picture.pixels
    found = lookalikes(pixels, shirt, model, W)
    h, w = pixels.shape[:2]
    step = -(-w // _SEEN_WIDTH_PX)
    small = np.ascontiguousarray(pixels[::step, ::step])
    return CameraSolution(
        drawn, problems, W, encode_seen(small, colours_alone(small, model, W)),
        found, described(found, (w, h)),
    )  # fmt: skip


def _missing(pictures: Mapping[str, LabelledPicture], model: ColourModel) -> tuple[str, ...]:
    """Names of the colours that have too few strokes in all cameras together."""
    pixels = np.zeros(COLOURS)
    for one in pictures.values():
        pixels += stroke_means(one.pixels, one.labels)[1]
    return tuple(model.names[k] for k in range(COLOURS) if pixels[k] < MIN_PIXELS)
