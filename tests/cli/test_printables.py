"""`mocapd board` and `mocapd shirt`, as a user meets them."""

from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

from mocapd.cli.command_list import app
from mocapd.errors import CannotCreateError, UsageError
from tests.cli.mocapd_process import mocapd_here
from tests.printing.printed import keywords, pages

Run = Callable[..., str]


@pytest.fixture
def run() -> Run:
    """One command in this process; returns what it prints."""

    def run_command(*words: str | Path) -> str:
        result = CliRunner().invoke(app, [str(word) for word in words], catch_exceptions=False)
        assert result.exit_code == 0
        return result.stdout

    return run_command


def test_a_board_and_the_flags_to_calibrate_with_it(
    clean_env: dict[str, str], tmp_path: Path
) -> None:
    out = tmp_path / "board.pdf"
    outcome = mocapd_here(
        clean_env, "board", "--out", out, "--paper", "letter", "--board-size", "8x5"
    )
    assert outcome.code == 0, outcome.err
    assert outcome.out.strip() == keywords(out.read_bytes())
    assert "--board charuco --board-size 8x5 --square 0.0" in outcome.out
    assert str(out) in outcome.err


def test_a_shirt(run: Run, tmp_path: Path) -> None:
    out = tmp_path / "shirt.pdf"
    assert run("shirt", "--out", out, "--size", "XXL", "--paper", "A3") == ""
    assert pages(out.read_bytes()) > 10
    assert "size=XXL" in keywords(out.read_bytes())


def test_a_board_of_a_given_square(run: Run, tmp_path: Path) -> None:
    words = ("--board-size", "4x5", "--square", "0.04", "--marker", "0.03", "--inverted")
    flags = run("board", "--out", tmp_path / "b.pdf", *words)
    assert "--square 0.04 --marker 0.03 --dictionary DICT_4X4_1000 --inverted" in flags


def test_a_board_of_two_sides_says_how_to_glue_it(
    clean_env: dict[str, str], tmp_path: Path
) -> None:
    out = tmp_path / "board.pdf"
    outcome = mocapd_here(clean_env, "board", "--out", out, "--two-sided")
    assert outcome.code == 0, outcome.err
    assert outcome.out.strip().endswith(" --two-sided")
    assert pages(out.read_bytes()) == 2
    assert "pins through the crosses of FRONT" in outcome.err


@pytest.mark.parametrize("command", ["board", "shirt"])
def test_the_help_has_an_example(run: Run, command: str) -> None:
    assert f"Example: mocapd {command} --out {command}.pdf" in run(command, "--help")


@pytest.mark.parametrize(
    ("words", "parts"),
    [
        (("board", "--paper", "A5"), ("--paper", "'A5'", "A4, Letter, A3")),
        (("board", "--board-size", "40x30"), ("40x30", "A4", "larger paper")),
        (("board", "--square", "0.06"), ("--square", "60 mm", "do not fit", "0.036")),
        (("board", "--board-size", "0x7"), ("0x7", "at least 3")),
        (("board", "--square", "-0.03"), ("--square", "-30 mm")),
        (("board", "--board-size", "five"), ("five", "columns x rows")),
        (("board", "--dictionary", "DICT_1"), ("DICT_1", "DICT_4X4_50")),
        (("shirt", "--size", "XXXL"), ("--size", "'XXXL'", "XXL")),
        (("shirt", "--paper", "A5"), ("--paper", "'A5'")),
    ],
)
def test_what_cannot_be_made_is_said(
    run: Run, tmp_path: Path, words: tuple[str, ...], parts: tuple[str]
) -> None:
    with pytest.raises(UsageError) as caught:
        run(*words, "--out", tmp_path / "out.pdf")
    for part in parts:
        assert part in str(caught.value)
    assert caught.value.fix
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("command", ["board", "shirt"])
@pytest.mark.parametrize("place", ["absent/out.pdf", "."])
def test_an_unwritable_path(run: Run, tmp_path: Path, command: str, place: str) -> None:
    with pytest.raises(CannotCreateError) as caught:
        run(command, "--out", tmp_path / place)
    assert str(tmp_path) in str(caught.value)
    assert "--out" in caught.value.fix
    assert list(tmp_path.iterdir()) == []


def test_it_is_one_line_on_stderr(clean_env: dict[str, str], tmp_path: Path) -> None:
    out = tmp_path / "absent" / "board.pdf"
    outcome = mocapd_here(clean_env, "board", "--out", out)
    assert (outcome.code, outcome.out) == (73, "")
    assert outcome.err.count("\n") == 1
    assert outcome.err.startswith(f"mocapd: {out}: ")
