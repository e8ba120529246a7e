"""The clients' programs, each run once for all tests of a file."""

import os
import shutil
from collections.abc import Callable
from typing import Any

import pytest

from tests.clients.godot import godot_player
from tests.clients.played import Played
from tests.clients.stream_cases import streams


def need(*packages_of: tuple[str, str]) -> None:
    """Skip where a program is missing, each named with its Debian package, unless MOCAPD_REQUIRE_CLIENTS is set."""
    packages = [package for program, package in packages_of if shutil.which(program) is None]
    if not packages:
        return
    reason = f"not installed: apt install {' '.join(packages)}"
    if os.environ.get("MOCAPD_REQUIRE_CLIENTS"):
        pytest.fail(reason)
    pytest.skip(reason)


@pytest.fixture(scope="session")
def godot_told(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What the Godot add-on made of every stream; one process."""
    need(("godot3-server", "godot3-server"))
    return godot_player.play(streams(), tmp_path_factory.mktemp("godot"))


PLAYERS = ("godot",)


@pytest.fixture(scope="module", params=PLAYERS)
def client(request: pytest.FixtureRequest) -> str:
    """Each game client in turn."""
    return str(request.param)


@pytest.fixture(scope="module")
def played(client: str, request: pytest.FixtureRequest) -> Callable[[str], Played]:
    """A stream by its name, as the client read it."""
    told = request.getfixturevalue(f"{client}_told")
    return lambda name: Played.read(told[name])
