"""The clients' programs, each run once for all tests."""

import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from mocapd.file_lock import one_at_a_time
from tests.clients.godot import godot_player
from tests.clients.played import Played
from tests.clients.stream_cases import Stream, streams
from tests.clients.unity import unity_player


def need(*packages_of: tuple[str, str]) -> None:
    """Skip where a program is missing, each named with its Debian package, unless MOCAPD_REQUIRE_CLIENTS is set."""
    packages = [package for program, package in packages_of if shutil.which(program) is None]
    if not packages:
        return
    reason = f"not installed: apt install {' '.join(packages)}"
    if os.environ.get("MOCAPD_REQUIRE_CLIENTS"):
        pytest.fail(reason)
    pytest.skip(reason)


def _told_once(
    play: Callable[[dict[str, Stream], Path], dict[str, Any]],
    name: str,
    factory: pytest.TempPathFactory,
) -> dict[str, Any]:
    """What a client makes of every stream: played once, also where several processes share the tests."""
    base = factory.getbasetemp()
    shared = base.parent if "PYTEST_XDIST_WORKER" in os.environ else base
    told = shared / f"{name}.json"
    with one_at_a_time(shared, f"{name}.lock"):
        if not told.is_file():
            told.write_text(json.dumps(play(streams(), factory.mktemp(name))))
    read: dict[str, Any] = json.loads(told.read_text())
    return read


@pytest.fixture(scope="session")
def godot_told(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What the Godot add-on made of every stream."""
    need(("godot3-server", "godot3-server"))
    return _told_once(godot_player.play, "godot", tmp_path_factory)


@pytest.fixture(scope="session")
def unity_told(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What the Unity package made of every stream."""
    need(("mcs", "mono-mcs"), ("mono", "mono-runtime"))
    return _told_once(unity_player.play, "unity", tmp_path_factory)


PLAYERS = ("godot", "unity")


@pytest.fixture(scope="module", params=PLAYERS)
def client(request: pytest.FixtureRequest) -> str:
    """Each game client in turn."""
    return str(request.param)


@pytest.fixture(scope="module")
def played(client: str, request: pytest.FixtureRequest) -> Callable[[str], Played]:
    """A stream by its name, as the client read it."""
    told = request.getfixturevalue(f"{client}_told")
    return lambda name: Played.read(told[name])
