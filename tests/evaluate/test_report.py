"""Tables, JSON, the page and its plots, from results that are known."""

import json
import re
from pathlib import Path

import cv2
import numpy as np
import pytest

from mocapd.errors import CannotCreateError
from mocapd.evaluate.capture_eval import CaptureResult
from mocapd.evaluate.compare import shoulder_angles
from mocapd.evaluate.pages.evaluation_page import page, write_page
from mocapd.evaluate.report import (
    comparison_tables,
    roc_table,
    score_json,
    score_table,
)
from mocapd.evaluate.runs import EvaluationResults
from mocapd.evaluate.tables import number, table
from tests.evaluate.results import a_roc, result_of
from tests.evaluate.tracks import FRAMES


def cells(text: str) -> dict[str, list[str]]:
    """The rows of a table by their first cell, rule and header left out."""
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in text.splitlines()[2:]]
    return {row[0]: row[1:] for row in rows}


def comparison() -> dict[str, list[CaptureResult]]:
    errors_m = {"full": 0.02, "paper": 0.03, "baseline": 0.05}
    return {
        variant: [result_of("desk", error_m), result_of("gym", 2 * error_m)]
        for variant, error_m in errors_m.items()
    }


def findings() -> EvaluationResults:
    compared = comparison()
    rocs = [("desk", a_roc()), ("gym", a_roc())]
    return EvaluationResults("colour, variant full", "upper", compared["full"], compared, rocs)


def test_a_table_is_aligned_markdown() -> None:
    assert table(["what", "a"], [["x", "1.5"], ["longer", "-"]]) == (
        "| what   |   a |\n| ------ | --: |\n| x      | 1.5 |\n| longer |   - |"
    )


@pytest.mark.parametrize(
    ("value", "text"),
    [(None, "-"), (float("nan"), "-"), (float("inf"), "never"), (1.0, "1.00"), (0.125, "0.12")],
)
def test_numbers(value: float | None, text: str) -> None:
    assert number(value, 2) == text


def test_the_table_of_scores_has_every_capture_and_the_means() -> None:
    results = [result_of("desk", 0.02), result_of("gym", 0.04), result_of("mono", 0.1, cameras=1)]
    rows = cells(score_table(results))
    assert list(rows) == ["desk", "gym", "mono", "mean of 2 with 2 cameras"]
    assert rows["desk"] == [
        *("100.0", "0", "2.00", "2.00", "2.00", "1.0", "0.0", "0"),
        *("100", "2.0", "-", "0.0", "-", "5.2"),
    ]
    assert rows["mean of 2 with 2 cameras"][2] == "3.00"


def test_a_light_that_is_never_recovered_from_is_told() -> None:
    error_m = np.where(np.arange(FRAMES) < 40, 0.02, 0.2)
    dark = result_of("dark", error_m, light_change_s=40 / 30)
    quick = result_of("quick", 0.01, light_change_s=40 / 30)
    rows = cells(score_table([dark, quick, result_of("desk", 0.02)]))
    assert [row[12] for row in rows.values()] == ["never", "0", "-", "never"]
    told = score_json([dark, quick, result_of("desk", 0.02)])
    assert [one["recovery_frames"] for one in told["captures"]] == ["never", 0.0, None]


def test_an_untracked_capture_has_no_figures_and_spoils_the_mean() -> None:
    results = [result_of("desk", 0.02), result_of("void", 0.0, keep=[])]
    rows = cells(score_table(results))
    assert rows["void"] == ["0.0", "0", *"-----------", "5.2"]
    assert rows["mean of 2 with 2 cameras"][2] == "-"
    assert json.loads(json.dumps(score_json(results), allow_nan=False))


def test_the_comparison_has_a_column_for_each_variant() -> None:
    rms, median, coverage = comparison_tables(comparison())
    header = [cell.strip() for cell in rms.splitlines()[0].split("|")[1:-1]]
    assert header == ["RMS [cm]", "full", "paper", "baseline"]
    assert cells(rms)["desk"] == ["2.00", "3.00", "5.00"]
    assert cells(rms)["mean of 2 with 2 cameras"] == ["3.00", "4.50", "7.50"]
    assert cells(median)["gym"] == ["4.00", "6.00", "10.00"]
    assert cells(coverage)["gym"] == ["100.0", "100.0", "100.0"]


def test_the_roc_as_a_table() -> None:
    rows = cells(roc_table(a_roc()))
    assert rows["5 %"] == ["18.8", "37.5"]
    assert list(rows) == ["0.5 %", "1 %", "2 %", "5 %", "10 %"]


def test_the_shoulder_has_gaps_where_nothing_was_tracked() -> None:
    compared = comparison()
    compared["baseline"][1] = result_of("gym", 0.05, keep=[f for f in range(10, FRAMES) if f != 40])
    desk, gym = shoulder_angles(compared)
    assert (desk.capture, gym.capture) == ("desk", "gym")
    assert np.abs(desk.angle_deg["truth"] - desk.angle_deg["full"]).max() < 1e-6
    assert np.isnan(gym.angle_deg["baseline"]).sum() == 1
    assert not np.isnan(gym.angle_deg["full"]).any()


def test_the_page_names_its_command_and_no_date() -> None:
    text = page(findings(), "mocapd eval desk gym --compare baseline --out docs")
    assert "mocapd eval desk gym --compare baseline --out docs\n```" in text
    assert all(one in text for one in comparison_tables(comparison()))
    assert not re.search(r"20[2-9]\d", text)
    assert "{" not in text


def test_the_page_and_its_plots_are_the_same_bytes_twice(tmp_path: Path) -> None:
    written = [write_page(tmp_path / name, findings(), "mocapd eval") for name in ("a", "b")]
    names = [path.relative_to(tmp_path / "a").as_posix() for path in written[0]]
    assert names == [
        "evaluation.md", "images/eval_confidence.png", "images/eval_shoulder.png", "images/eval_roc.png",
    ]  # fmt: skip
    text = written[0][0].read_text()
    for first, second in zip(*written, strict=True):
        assert first.read_bytes() == second.read_bytes()
        if first.suffix == ".png":
            assert f"({first.relative_to(tmp_path / 'a').as_posix()})" in text
            picture = cv2.imread(str(first))
            assert picture is not None
            assert picture.shape[1] > 600


def test_without_a_comparison_there_is_but_one_table(tmp_path: Path) -> None:
    alone = EvaluationResults("canned", "upper", [result_of("desk", 0.02)], {}, ())
    written = write_page(tmp_path, alone, "mocapd eval desk")
    assert [path.name for path in written] == ["evaluation.md", "eval_confidence.png"]
    assert written[0].read_text().count("![") == 1


def test_against_other_ways_there_is_nothing_of_the_shirts_paper(tmp_path: Path) -> None:
    compared = {"full": [result_of("desk", 0.02)], "no occlusion": [result_of("desk", 0.05)]}
    others = EvaluationResults("flex_paper", "full", compared["full"], compared, ())
    written = write_page(tmp_path, others, "mocapd eval desk")
    assert [path.name for path in written] == ["evaluation.md", "eval_confidence.png"]
    text = written[0].read_text()
    assert "no occlusion" in text
    assert "Wang" not in text


def test_a_place_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(CannotCreateError, match=r"evaluation\.md: cannot be written.*--out"):
        write_page(tmp_path / "file", findings(), "mocapd eval")
