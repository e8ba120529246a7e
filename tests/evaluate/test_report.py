"""Tables, JSON, the page and its plot, from results that are known."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from mocapd.errors import CannotCreateError
from mocapd.evaluate.report import score_json, score_table
from mocapd.evaluate.score_page import page, write_page
from mocapd.evaluate.tables import number, table
from tests.evaluate.results import result_of
from tests.evaluate.tracks import FRAMES


def cells(text: str) -> dict[str, list[str]]:
    """The rows of a table by their first cell, rule and header left out."""
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in text.splitlines()[2:]]
    return {row[0]: row[1:] for row in rows}


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


def test_the_page_names_its_command_and_no_date() -> None:
    text = page([result_of("desk", 0.02)], "shirt", "upper", "mocapd eval desk --out scores")
    assert "mocapd eval desk --out scores\n```" in text
    assert not re.search(r"20[2-9]\d", text)
    assert "{" not in text


def test_the_page_has_one_plot(tmp_path: Path) -> None:
    written = write_page(tmp_path, [result_of("desk", 0.02)], "canned", "upper", "mocapd eval desk")
    assert [path.name for path in written] == ["evaluation.md", "eval_confidence.png"]
    assert written[0].read_text().count("![") == 1


def test_a_place_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(CannotCreateError, match=r"evaluation\.md: cannot be written.*--out"):
        write_page(tmp_path / "file", [result_of("desk", 0.02)], "canned", "upper", "mocapd eval")
