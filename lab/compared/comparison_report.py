"""Several methods side by side, as tables and as JSON."""

from typing import Any

from lab.compared.compare import Comparison
from lab.compared.roc import Roc, correct_at
from mocapd.evaluate.report import COLUMNS, groups_by_cameras, mean_or_nan
from mocapd.evaluate.tables import number, table

FALSE_RATES = (0.005, 0.01, 0.02, 0.05, 0.1)


def comparison_tables(comparison: Comparison) -> list[str]:
    """Per capture and method: RMS error [cm], as in the paper's Fig. 9; its median; the coverage [%].

    An error is that of the tracked frames alone, so the coverage belongs to it; the median tells a
    tracker that is a little off everywhere from one that is right but for a few frames.
    """
    return [_side_by_side(comparison, key) for key in ("rms_cm", "median_cm", "coverage_percent")]


def roc_table(roc: Roc) -> str:
    """Share of the shirt classified correctly at some rates of false positives."""
    rows = [
        [
            f"{100 * rate:g} %",
            number(100.0 * correct_at(roc.alone, rate), 1),
            number(100.0 * correct_at(roc.assisted, rate), 1),
        ]
        for rate in FALSE_RATES
    ]
    return table(["false positives", "step 1 alone [%]", "pose-assisted [%]"], rows)


def roc_json(roc: Roc) -> dict[str, Any]:
    """The curves as lists of shares."""
    curves = {"step_1": roc.alone, "pose_assisted": roc.assisted, "tracker": roc.tracker}
    return {
        name: {"false": counts.false.tolist(), "correct": counts.correct.tolist()}
        for name, counts in curves.items()
    }


def _side_by_side(comparison: Comparison, key: str) -> str:
    title, digits, value = next(column[1:] for column in COLUMNS if column[0] == key)
    columns = list(comparison.values())
    rows = [
        [results[0].case.name, *(number(value(result), digits) for result in results)]
        for results in zip(*columns, strict=True)
    ]
    for groups in zip(*map(groups_by_cameras, columns), strict=True):
        means = [mean_or_nan([value(result) for result in group]) for _, group in groups]
        rows.append([groups[0][0], *(number(mean, digits) for mean in means)])
    return table([title, *comparison], rows)
