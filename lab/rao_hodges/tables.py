"""The tables of the experiment."""

from collections.abc import Mapping, Sequence

import numpy as np

from lab.rao_hodges.clip_angles import LimbAngles
from lab.rao_hodges.experiment import LimbOutcome, LimbVariant

Tracked = Sequence[tuple[LimbAngles, LimbOutcome]]

PAPER = "| the paper, with a GPU | 7.73 | | 4.54 | 19.3 | | 4 |"


def experiment_tables(
    results: Mapping[LimbVariant, Tracked],
    ablations: Mapping[LimbVariant, Tracked],
    clips: int,
    ablated: int,
    seconds: float,
    command: str,
) -> str:
    """Errors and rate of each variant, then what each comparison of the paper changes."""
    lines = [
        f"`{command}`: {clips} clips, the first {seconds:g} s of each at 60 Hz",
        "",
        "| | mean [deg] | Euclidean [deg] | sigma [deg] | largest of a clip [deg] | largest of a frame [deg] | rate [Hz] |",
        "|---|---:|---:|---:|---:|---:|---:|",
        PAPER,
    ]
    for variant, tracked in results.items():
        lines.append(_row(variant.label, tracked))
        lines += [
            _row(
                f"{variant.label}: {name}",
                [one for one in tracked if ("legs" in one[0].limb) == legs],
            )
            for name, legs in (("legs", True), ("arms", False))
        ]
    lines += [
        "",
        f"Legs of {ablated} of the clips:",
        "",
        "| | mean [deg] | against published [deg] | largest of a frame [deg] | spread [deg] | exchanged [%] |",
        "|---|---:|---:|---:|---:|---:|",
    ]
    usual = _frame_errors(next(iter(ablations.values()))).mean()
    for variant, tracked in ablations.items():
        errors = _frame_errors(tracked)
        spread = np.concatenate([outcome.spread_deg for _, outcome in tracked]).mean()
        apart = max(sum(outcome.apart for _, outcome in tracked), 1)
        exchanged = sum(outcome.exchanged for _, outcome in tracked)
        lines.append(
            f"| {variant.label} | {errors.mean():.2f} | {errors.mean() - usual:+.2f} | {errors.max():.1f} | {spread:.2f} "
            f"| {100.0 * exchanged / apart:.1f} |"
        )
    return "\n".join(lines) + "\n"


def _row(label: str, tracked: Tracked) -> str:
    errors = _frame_errors(tracked)
    norm = np.concatenate([np.linalg.norm(o.errors_deg, axis=1) for _, o in tracked]).mean()
    means = [outcome.errors_deg.mean() for _, outcome in tracked]
    rate_hz = len(errors) / sum(outcome.cpu_s for _, outcome in tracked)
    return (
        f"| {label} | {errors.mean():.2f} | {norm:.2f} | {errors.std():.2f} | {max(means):.1f} | {errors.max():.1f} "
        f"| {rate_hz:.0f} |"
    )


def _frame_errors(tracked: Tracked) -> np.ndarray:
    return np.concatenate([outcome.errors_deg.mean(axis=1) for _, outcome in tracked])
