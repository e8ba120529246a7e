"""Methods side by side: tables, the page and its plots, from results that are known."""

import re
from pathlib import Path

import cv2
import numpy as np

from lab.compared.compare import shoulder_angles
from lab.compared.compared_runs import EvaluationResults
from lab.compared.comparison_report import comparison_tables, roc_table
from lab.compared.roc import ALONE_THRESHOLDS, Counts, Roc
from lab.pages.evaluation_page import page, write_page
from mocapd.evaluate.capture_eval import CaptureResult
from tests.evaluate.results import result_of
from tests.evaluate.test_report import cells
from tests.evaluate.tracks import FRAMES

N = len(ALONE_THRESHOLDS)


def a_roc() -> Roc:
    """Colour alone finds half of what the pose helps to find."""
    return Roc(
        Counts(np.linspace(10.0, 45.0, N), np.linspace(0.0, 200.0, N), 100.0, 1000.0),
        Counts(np.linspace(20.0, 90.0, N), np.linspace(0.0, 200.0, N), 100.0, 1000.0),
        Counts(np.array([80.0]), np.array([10.0]), 100.0, 1000.0),
    )


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
    text = page(findings(), "python -m lab.evaluation desk gym --compare --out docs")
    assert "python -m lab.evaluation desk gym --compare --out docs\n```" in text
    assert all(one in text for one in comparison_tables(comparison()))
    assert not re.search(r"20[2-9]\d", text)
    assert "{" not in text


def test_the_page_and_its_plots_are_the_same_bytes_twice(tmp_path: Path) -> None:
    written = [
        write_page(tmp_path / name, findings(), "python -m lab.evaluation") for name in ("a", "b")
    ]
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


def test_against_other_ways_there_is_nothing_of_the_shirts_paper(tmp_path: Path) -> None:
    compared = {"full": [result_of("desk", 0.02)], "no occlusion": [result_of("desk", 0.05)]}
    others = EvaluationResults("hecht2009", "full", compared["full"], compared, ())
    written = write_page(tmp_path, others, "python -m lab.evaluation desk")
    assert [path.name for path in written] == ["evaluation.md", "eval_confidence.png"]
    text = written[0].read_text()
    assert "no occlusion" in text
    assert "Wang" not in text
