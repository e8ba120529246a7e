"""No printed line asks a package index for what it does not have, or names a path that is not there.

`python -m tests.supply.install_lines` runs them, which takes an index and minutes.
"""

import re
import shlex

import pytest

from mocapd.extras import EXTRAS, install_command, reinstall_command
from tests.supply.install_lines import FROM_INDEX, ROOT, Line, blocks, installing, lines

OURS = re.compile(r"^(mocapd|mocapd[-_]?(client|goalkeeper|analysis)|goalkeeper)([\[<>=].*)?$")
OF_DIST = re.compile(r"dist/(mocapd|mocapd_client|mocapd_goalkeeper)-\*\.whl")


@pytest.mark.parametrize("line", lines(), ids=lambda line: f"{line.page}: {line.command}")
def test_a_printed_line_installs_from_a_path_a_wheel_or_what_the_index_has(line: Line) -> None:
    command = (
        line.command.replace('"$(ls ', "")
        .replace(')[print]"', "[print]")
        .replace(')[vrchat]"', "[vrchat]")
    )
    words = shlex.split(command, comments=True)
    verb = next(i for i, word in enumerate(words) if word in ("install", "inject"))
    named = [word for word in words[verb + 1 :] if not word.startswith("-")]
    if "inject" in words:
        named = named[1:]  # the environment, which has mocapd
    assert named
    for name in named:
        bare = name.partition("[")[0].strip(')"')
        if OF_DIST.fullmatch(bare):
            continue
        if bare.startswith(".") or "/" in bare:
            assert (ROOT / bare / "pyproject.toml").is_file(), name
        else:
            assert not OURS.match(name), f"no index has {name}"
            assert bare in FROM_INDEX | set(EXTRAS.values()), name


@pytest.mark.parametrize("line", lines(), ids=lambda line: f"{line.page}: {line.command}")
def test_nobody_is_sent_to_the_systems_own_python(line: Line) -> None:
    """Debian's refuses, and root would break it."""
    assert not re.match(r"(sudo )?(python3? -m )?pip ", line.command)


def test_every_block_of_commands_makes_what_it_installs_into() -> None:
    for page, text in blocks():
        told = installing(text)
        assert "-m venv" in told or "pipx" in told or "dist/" in told, page


def test_messages_name_a_command_that_can_be_typed() -> None:
    for extra in EXTRAS:
        assert not re.search(r"install mocapd\b", install_command(extra))
    assert "dist/mocapd-*.whl" in reinstall_command()
