"""Repeat the experiment of Rao and Hodges on clips of real motion, with their own comparisons.

python -m lab.rao_hodges CLIPS
"""

import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from lab.command_line import repeat, run
from lab.rao_hodges.clip_angles import LIMBS, LimbAngles, limb_angles
from lab.rao_hodges.experiment import LimbOutcome, LimbVariant, track_limb
from lab.rao_hodges.tables import experiment_tables
from lab.simulated.motion_clip import read_clip
from mocapd.errors import InputError
from mocapd.published.rao_hodges.annealing import AnnealingParams, Selection

VARIANTS = (
    LimbVariant("as published"),
    LimbVariant("with the converse term", converse=1.0),
    LimbVariant("converse term, six layers", converse=1.0, annealing=AnnealingParams(layers=6)),
)
ABLATIONS = (
    LimbVariant("as published"),
    LimbVariant("2D weight", silhouettes=True),
    LimbVariant("random selection", annealing=AnnealingParams(selection=Selection.RANDOM)),
    LimbVariant("crossover", annealing=AnnealingParams(crossover=True)),
    LimbVariant("PCA", components=5),
)


def experiment(
    clips: Annotated[Path, typer.Argument(help="A folder of clips of motion.")],
    count: Annotated[int, typer.Option(help="How many clips, spread over the folder.")] = 24,
    ablated: Annotated[int, typer.Option(help="Of how many of them the legs are ablated.")] = 8,
    seconds: Annotated[float, typer.Option(help="Of each clip, from its begin.")] = 2.5,
) -> None:
    """Track legs and arms in synthetic points of clips, root given, and compare as the paper does."""
    paths = sorted(clips.glob("[!.]*.npz"))
    if len(paths) < 2:
        raise InputError("has fewer than two clips of motion", str(clips), "give another folder")
    chosen = [paths[k] for k in _spread(len(paths), count)]
    read = [read_clip(path) for path in chosen]
    truths, halved = (
        [_begin(limb_angles(clip, limb, every), seconds) for clip in read for limb in LIMBS]
        for every in (1, 2)
    )
    results = {variant: _tracked(truths, variant) for variant in VARIANTS}
    results[LimbVariant("as published, at 30 Hz")] = _tracked(halved, VARIANTS[0])
    legs = [truth for truth in truths if truth.limb == "legs"]
    some = [legs[k] for k in _spread(len(legs), ablated)]
    ablations = {variant: _tracked(some, variant, legs) for variant in ABLATIONS}
    command = repeat("lab.rao_hodges", clips)
    text = experiment_tables(results, ablations, len(read), len(some), seconds, command)
    sys.stdout.write(text)


def _tracked(
    truths: Sequence[LimbAngles], variant: LimbVariant, learned: Sequence[LimbAngles] = ()
) -> list[tuple[LimbAngles, LimbOutcome]]:
    sys.stderr.write(f"{variant.label}\n")
    return [
        (
            truth,
            track_limb(truth, variant, seed, [one for one in learned if one.clip != truth.clip]),
        )
        for seed, truth in enumerate(truths)
    ]


def _spread(total: int, count: int) -> list[int]:
    return sorted({round(k) for k in np.linspace(0, total - 1, min(count, total)).tolist()})


def _begin(truth: LimbAngles, seconds: float) -> LimbAngles:
    """The first frames of a clip."""
    return replace(truth, angles=truth.angles[: round(seconds / truth.dt_s) + 1])


if __name__ == "__main__":
    run(experiment)
