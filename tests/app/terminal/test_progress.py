"""Progress bars on a terminal."""

import io

import pytest
from rich.console import Console

from mocapd.app.terminal import progress
from mocapd.app.terminal.progress import ProgressBars


@pytest.fixture
def shown(monkeypatch: pytest.MonkeyPatch) -> io.StringIO:
    """What a terminal gets."""
    written = io.StringIO()
    terminal = Console(file=written, force_terminal=True, width=100)
    monkeypatch.setattr(progress, "Console", lambda stderr: terminal)
    return written


@pytest.mark.parametrize("name", ["take[red]", "take [2]", "/home/me/[/x]"])
def test_a_name_with_brackets_is_shown_as_it_is(shown: io.StringIO, name: str) -> None:
    with ProgressBars() as bars:
        bars.begin(name)
        bars(f"tracking {name}", 1, 1)
    headline, *bar = shown.getvalue().splitlines()
    assert headline == name
    assert any(f"tracking {name}" in line for line in bar)
