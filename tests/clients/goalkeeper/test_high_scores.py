"""High scores: best first, ten at most, and no file is worth a crash."""

from pathlib import Path

import pytest

from goalkeeper.app.high_scores import KEPT, Placed, keep_name, keep_round, read_high_scores
from goalkeeper.app.options import parse_options
from goalkeeper.core.scoring import Score

DAY = "2026-01-02"


def _score(points: int) -> Score:
    return Score(points=points, saves=3, goals=1, streak=2, best_streak=3)


def test_they_are_kept_best_first(tmp_path: Path) -> None:
    path = tmp_path / "data" / "high_scores.json"
    for points, place in ((300, 0), (500, 0), (400, 1), (0, None)):
        placed = keep_round(path, _score(points), DAY)
        assert placed.place == place
        assert placed.trouble == ""
    assert [one.points for one in read_high_scores(path)] == [500, 400, 300]


def test_a_name_is_kept_also_one_that_is_typed_later(tmp_path: Path) -> None:
    path = tmp_path / "high_scores.json"
    keep_round(path, _score(500), DAY, "Noor")
    placed = keep_round(path, _score(400), DAY)
    keep_name(path, placed, "Kim")
    assert [one.name for one in read_high_scores(path)] == ["Noor", "Kim"]
    assert keep_name(path, Placed((), None), "Kim").scores == ()


@pytest.mark.parametrize("name", ["x" * 41, "Ki\nm", "Ki\udcffm"])
def test_a_name_that_the_table_cannot_hold_is_refused_at_the_start(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Else the table could not be read any more."""
    with pytest.raises(SystemExit):
        parse_options(["--name", name])
    assert "argument --name" in capsys.readouterr().err
    assert parse_options(["--name", "x" * 40]).name == "x" * 40


def test_a_table_of_an_earlier_version_has_no_names(tmp_path: Path) -> None:
    path = tmp_path / "high_scores.json"
    row = '{"points": 5, "saves": 1, "goals": 0, "best_streak": 1, "date": "2026-01-01"}'
    path.write_text(f'{{"scores": [{row}]}}')
    assert [one.name for one in read_high_scores(path)] == [""]


def test_the_eleventh_best_is_forgotten(tmp_path: Path) -> None:
    path = tmp_path / "high_scores.json"
    for points in range(1, KEPT + 2):
        keep_round(path, _score(points), DAY)
    assert [one.points for one in read_high_scores(path)] == list(range(KEPT + 1, 1, -1))
    assert keep_round(path, _score(1), DAY).place is None


def test_a_damaged_file_is_said_and_left_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "high_scores.json"
    for damaged in ("{", '{"scores": [{"points": -1}]}', "[1, 2]"):
        path.write_text(damaged)
        placed = keep_round(path, _score(100), DAY)
        assert placed.place == 0
        assert "high_scores.json" in placed.trouble
        named = keep_name(path, placed, "Kim")
        assert (named.scores[0].name, named.trouble) == ("Kim", placed.trouble)
        assert path.read_text() == damaged


def test_a_folder_that_cannot_be_made_is_said(tmp_path: Path) -> None:
    (tmp_path / "data").write_text("a file in its place")
    placed = keep_round(tmp_path / "data" / "high_scores.json", _score(100), DAY)
    assert placed.place == 0
    assert "cannot be written" in placed.trouble
