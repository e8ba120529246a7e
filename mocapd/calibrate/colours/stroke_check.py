"""Checks a user's strokes: enough colours, and one light that explains all of them.

Each connected stroke is one witness. From every plausible light (`light_hypotheses`) iteratively reweighted
least squares with the weights of [Geman & McClure 1987] solves a white balance, in which a witness weighs less
the worse it agrees. The light with the most agreement wins, and strokes that disagree with it were drawn on
another patch.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np

from mocapd.calibrate.colours.light_hypotheses import light_hypotheses
from mocapd.errors import InputError
from mocapd.shirt.colour.colour_model import ColourModel
from mocapd.shirt.colour.strokes import COLOURS
from mocapd.shirt.colour.white_balance import shade_precision, solve_white_balance
from mocapd.types import Bytes, Floats, Ints

LEAST_COLOURS = 5  # W has nine unknowns, and shade hides one number of each colour's three
LEAST_PX = 12  # of a stroke to check
_ROUNDS = 8
_AGREES = 2.5  # standard deviations (hue first, see `shade_precision`) at which a witness counts a quarter
_WRONG = 4.5  # standard deviations from where a stroke is called wrong
_BETTER = 0.5  # of its distance, at which another colour explains a stroke better
_RIDGE = 0.01
_SHADING, _NOISE = 0.3, 0.05
_MAJORITY = 0.6  # share of the witnesses that must agree on one light


@dataclass(frozen=True, slots=True)
class StrokeProblem:
    """A problem of the strokes: its colours (ids 1..10), places [px], and remedy.

    serious: it prevents solving W; otherwise the colour's other strokes outweigh the wrong one.
    """

    colours: tuple[int, ...]
    at_px: tuple[tuple[int, int], ...]
    what: str
    fix: str
    serious: bool = True


@dataclass(frozen=True, slots=True, eq=False)
class _Witnesses:
    """One connected stroke each: colour (S,) 0..9, mean RGB (S,3), place (S,2) [px], weight (S,)."""

    colour: Ints
    mean: Floats
    at_px: Ints
    weight: Floats


def check_strokes(pixels: Bytes, strokes: Bytes, model: ColourModel) -> tuple[StrokeProblem, ...]:
    """Problems of strokes (H,W) on a picture (H,W,3) BGR, none for usable strokes."""
    witnesses = _witnesses(pixels, strokes)
    drawn = np.unique(witnesses.colour)
    if len(drawn) < LEAST_COLOURS:
        missing = [k for k in range(COLOURS) if k not in drawn]
        return (
            StrokeProblem(
                tuple(k + 1 for k in missing),
                (),
                f"only {len(drawn)} of {COLOURS} colours have strokes"
                f" ({_colour_list(model, drawn.tolist()) or 'none'})",
                f"draw on at least {LEAST_COLOURS - len(drawn)} more of: {_colour_list(model, missing)}",
            ),
        )
    distance = _consensus(pixels, witnesses, model)
    agreeing = distance[np.arange(len(witnesses.colour)), witnesses.colour] < _WRONG
    if witnesses.weight[agreeing].sum() < _MAJORITY * witnesses.weight.sum():
        return (
            StrokeProblem(
                tuple(int(k) + 1 for k in drawn),
                (),
                f"no light makes these strokes the shirt's colours ({_colour_list(model, drawn.tolist())})",
                "erase them and draw each colour on its own patch, as the card of the shirt shows",
            ),
        )
    return tuple(_misplaced_strokes(witnesses, distance, agreeing, model))


def require_good_strokes(pixels: Bytes, strokes: Bytes, model: ColourModel, where: str) -> None:
    """Raises InputError that names every serious problem of the strokes; `where`: their file or camera."""
    problems = [p for p in check_strokes(pixels, strokes, model) if p.serious]
    if problems:
        raise InputError(
            "; ".join(p.what for p in problems), where, "; ".join(p.fix for p in problems)
        )


def _misplaced_strokes(
    witnesses: _Witnesses, distance: Floats, agreeing: np.ndarray, model: ColourModel
) -> Iterator[StrokeProblem]:
    for k in np.unique(witnesses.colour[~agreeing]):
        mine = np.flatnonzero(~agreeing & (witnesses.colour == k))
        like = int(np.argmin(np.average(distance[mine], axis=0, weights=witnesses.weight[mine])))
        name, other = model.names[k], model.names[like]
        looks = like != k and (distance[mine, like] < _BETTER * distance[mine, k]).all()
        yield StrokeProblem(
            (int(k) + 1, like + 1) if looks else (int(k) + 1,),
            tuple((int(x), int(y)) for x, y in witnesses.at_px[mine]),
            f"the stroke for {name} lies on what looks {other} in this light"
            if looks
            else f"the stroke for {name} lies on no colour of the shirt",
            f"erase it and draw {name} on the {name} patch",
            bool(
                2.0 * witnesses.weight[mine].sum() >= witnesses.weight[witnesses.colour == k].sum()
            ),
        )


def _witnesses(pixels: Bytes, strokes: Bytes) -> _Witnesses:
    colours, means, places, weights = [], [], [], []
    for k in range(COLOURS):
        count, parts = cv2.connectedComponents((strokes == k + 1).astype(np.uint8))
        for part in range(1, count):
            y, x = np.nonzero(parts == part)
            if len(x) < LEAST_PX:
                continue
            colours.append(k)
            # the median ignores ends that cross the border
            means.append(np.median(pixels[y, x][:, ::-1], axis=0) / 255.0)
            middle = int(np.argmin((x - x.mean()) ** 2 + (y - y.mean()) ** 2))
            places.append((x[middle], y[middle]))
            weights.append(np.sqrt(len(x)))
    return _Witnesses(
        np.array(colours, np.int64),
        np.array(means, float).reshape(-1, 3),
        np.array(places, np.int64).reshape(-1, 2),
        np.array(weights, float),
    )


def _consensus(pixels: Bytes, witnesses: _Witnesses, model: ColourModel) -> Floats:
    """Distances (S,10) of the witnesses to every colour, under the W with the most agreement."""
    covariance = model.tolerating(_SHADING, _NOISE).tolerant_covariance
    whitening = np.linalg.inv(np.linalg.cholesky(covariance))
    precision = shade_precision(model)[witnesses.colour]
    best, most = np.eye(3), -1.0
    rows = np.arange(len(witnesses.colour))
    for start in light_hypotheses(pixels[::4, ::4]):
        W = start
        for _ in range(_ROUNDS):
            off = _distances(W, witnesses.mean, model.mean, whitening)[rows, witnesses.colour]
            trust = witnesses.weight / (1.0 + (off / _AGREES) ** 2) ** 2
            W = solve_white_balance(
                witnesses.mean, model.mean[witnesses.colour], trust, start, _RIDGE, precision
            )
        off = _distances(W, witnesses.mean, model.mean, whitening)[rows, witnesses.colour]
        agreed = float((witnesses.weight / (1.0 + (off / _AGREES) ** 2)).sum())
        if agreed > most and _plausible(W):
            best, most = W, agreed
    return _distances(best, witnesses.mean, model.mean, whitening)


def _distances(W: Floats, image: Floats, mean: Floats, whitening: Floats) -> Floats:
    """Mahalanobis distances (S,10) of image colours (S,3) to the model's under W."""
    off = (image @ W.T)[:, None, :] - mean
    distances: Floats = np.linalg.norm(np.einsum("kab,skb->ska", whitening, off), axis=2)
    return distances


def _plausible(W: Floats) -> bool:
    """Whether a light and a camera can produce W: each channel mostly comes from its own."""
    diagonal = np.diag(W)
    mixed = np.abs(W - np.diag(diagonal)).sum(axis=1)
    return bool((diagonal > 0.2).all() and (diagonal < 6.0).all() and (mixed < diagonal).all())


def _colour_list(model: ColourModel, colours: list[int]) -> str:
    return ", ".join(model.names[k] for k in colours)
