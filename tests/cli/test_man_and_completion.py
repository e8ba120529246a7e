"""The manual page and the Tab key know what the command line knows."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Annotated

import pytest
import typer
import typer.main

from mocapd.cli.care.man_page import man_page
from mocapd.cli.care.status import NOT_RUNNING, SLOW, UNABLE, UNKNOWN
from mocapd.cli.command_list import app
from tests.cli.mocapd_process import COMMAND, mocapd_here

PATIENCE_S = 120.0


def page_of(app: typer.Typer) -> str:
    return man_page(typer.main.get_command(app))


def shown(page: str) -> str:
    """As a reader sees it. Fails on anything that groff warns of."""
    if shutil.which("groff") is None:
        pytest.skip("groff is not installed")
    done = subprocess.run(
        ["groff", "-man", "-Tascii", "-P-c", "-ww"],
        input=page,
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=True,
    )
    assert done.stderr == ""
    return re.sub(".\b", "", done.stdout)  # bold is struck twice


def test_the_page_has_every_command_and_every_option_that_help_shows() -> None:
    page = page_of(app).replace(r"\-", "-")
    group = typer.main.get_command(app)
    assert isinstance(group, typer.core.TyperGroup)
    assert len(group.commands) > 15
    for name, command in group.commands.items():
        assert f'.SS "mocapd {name} ' in page
        for parameter in command.params:
            if parameter.get_help_record(typer.Context(command)) is not None:
                assert any(one in page for one in parameter.opts), (name, parameter.opts)
    assert "--variant" not in page  # hidden


def test_the_page_has_every_exit_code_of_status() -> None:
    codes = f"{NOT_RUNNING}, {UNKNOWN}, {UNABLE}, {SLOW}"
    assert f"\\fB{codes}\\fR\nof status alone" in page_of(app)


def test_groff_shows_it_without_a_warning() -> None:
    text = shown(page_of(app))
    assert "mocapd status --json | jq .state" in text
    assert re.search(r"78\s+the configuration or a calibration is wrong", text)
    assert page_of(app) == page_of(app)


def test_nothing_that_a_help_says_is_taken_for_a_command_of_roff() -> None:
    wild = typer.Typer(rich_markup_mode=None)

    @wild.command("wild")
    def command(
        flag: Annotated[str, typer.Option(help=r".so /etc/passwd \fBbold\n 'quoted' ~^`")] = "",
    ) -> None:
        """.TH OTHER 1

        'ab "quoted" -- 3 × 4 \\n(.H
        """

    @wild.command("tame")
    def other() -> None:
        """Tame."""

    text = shown(page_of(wild))
    for told in (".TH OTHER 1", r".so /etc/passwd \fBbold\n 'quoted' ~^`", '\'ab "quoted" -- 3'):
        assert told in text
    assert "OTHER(1)" not in text


def test_the_command_prints_the_page() -> None:
    done = mocapd_here(dict(os.environ), "man")
    assert (done.code, done.err) == (0, "")
    assert done.out == page_of(app)


@pytest.fixture
def on_path(tmp_path: Path) -> dict[str, str]:
    """An environment in which `mocapd` is a command."""
    script = tmp_path / "mocapd"
    script.write_text(f'#!/bin/sh\nexec {" ".join(COMMAND)} "$@"\n')
    script.chmod(0o755)
    folder = Path(sys.executable).parent
    return {**os.environ, "PATH": f"{tmp_path}:{folder}:{os.environ['PATH']}"}


@pytest.mark.parametrize(
    ("typed", "offered"),
    [
        ("mocapd sta", {"status"}),
        ("mocapd re", {"record", "replay", "reload", "recenter"}),
        ("mocapd watch --j", {"--json"}),
        ("mocapd completion ", {"bash", "zsh", "fish"}),
        ("mocapd run --set zenoh.po", {"zenoh.port="}),
        ("mocapd export --to b", {"bvh"}),
    ],
)
def test_bash_offers_what_fits(on_path: dict[str, str], typed: str, offered: set[str]) -> None:
    words = typed.split(" ")
    quoted = " ".join(f'"{word}"' for word in words)
    script = f"""
        eval "$(mocapd completion bash)"
        COMP_WORDS=({quoted})
        COMP_CWORD={len(words) - 1}
        _mocapd_completion mocapd
        echo "${{COMPREPLY[@]}}"
    """
    done = subprocess.run(
        ["bash", "-c", script],
        env=on_path,
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=True,
    )
    assert set(done.stdout.split()) == offered


@pytest.mark.parametrize("shell", ["zsh", "fish"])
def test_other_shells_get_their_own_script(shell: str) -> None:
    done = mocapd_here(dict(os.environ), "completion", shell)
    assert done.code == 0
    assert f"_MOCAPD_COMPLETE=complete_{shell}" in done.out


def test_a_shell_that_is_none_is_a_usage_error() -> None:
    done = mocapd_here(dict(os.environ), "completion", "tcsh")
    assert done.code == 2
    assert "tcsh" in done.err
