"""Save in the wizard, and SIGHUP: the session is another, and who subscribes to the service stays connected."""

import json
import signal
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest

from mocapd.cli.care.status import SLOW
from tests.cli.mocapd_process import mocapd
from tests.cli.own_time import end_within
from tests.conftest import environment
from tests.e2e.replaced import (
    INSTANCE,
    Daemon,
    Game,
    save_in_the_wizard,
    wait_until,
    write_calibration,
)

pytestmark = pytest.mark.kernels

STATURE_M = 1.75
MOST_S = 1.0  # without a frame, while the cameras are closed and opened
TAKEN_UP = "taken up, within"
GOES_ON = "but the session goes on as it was"


@pytest.fixture(scope="module")
def daemon(tmp_path_factory: pytest.TempPathFactory, cache_home: Path) -> Iterator[Daemon]:
    folder = tmp_path_factory.mktemp("replaced")
    write_calibration(folder, cache_home / "mocapd", STATURE_M)
    one = Daemon(environment(folder, cache_home), folder)
    yield one
    one.close()


@pytest.fixture(scope="module")
def game(daemon: Daemon) -> Iterator[Game]:
    daemon.page()
    one = Game(daemon)
    yield one
    one.close()


def connected_throughout(game: Game, since: int, what: str) -> None:
    """Nothing but a short gap was seen of the change; prints how long that was."""
    seqs = [one.seq for one in game.heard[since:]]
    assert all(a < b for a, b in pairwise(seqs))
    assert game.departures == 0
    assert game.connected() == game.peers
    print(f"{what}: {game.gap_s(since):.3f} s without a frame")
    assert game.own_gap_s(since) <= MOST_S


def test_save_in_the_wizard_changes_the_session_under_who_is_connected(
    daemon: Daemon, game: Game
) -> None:
    wait_until(game.is_live, "a person")
    since, started = len(game.heard), game.ask("health")["started_unix_ns"]
    assert game.ask("rest_skeleton/0")["stature_m"] == STATURE_M
    changes = daemon.log.count(TAKEN_UP)
    game.rests.clear()
    save_in_the_wizard(daemon.page(), 1.72)
    daemon.told(TAKEN_UP, changes + 1)
    taken = len(game.heard)
    wait_until(lambda: len(game.heard) > taken + 30 and game.is_live(), "the person again")
    connected_throughout(game, since, "Save")
    rest = game.ask("rest_skeleton/0")
    assert rest["stature_m"] == 1.72
    assert game.rests[-1] == rest  # those who listen need not ask
    assert game.ask("calibration")["source"].endswith("calibration.toml")
    assert game.ask("health")["started_unix_ns"] == started


def test_sighup_reads_configuration_and_calibration_again(daemon: Daemon, game: Game) -> None:
    wait_until(game.is_live, "a person")
    since, sets = len(game.heard), game.ask("health")["frame_sets"]
    changes = daemon.log.count(TAKEN_UP)
    daemon.assume_stature(1.78)
    daemon.configure("smoothing.preset = 'smooth'", "web.port = 0", "osc.destinations = []")
    daemon.reload()
    daemon.told(TAKEN_UP, changes + 1)
    daemon.told("only for the next start: osc")
    taken = len(game.heard)
    wait_until(lambda: len(game.heard) > taken + 30 and game.is_live(), "the person again")
    connected_throughout(game, since, "SIGHUP")
    assert game.ask("rest_skeleton/0")["stature_m"] == 1.78
    wait_until(lambda: game.ask("health")["frame_sets"] > sets, "frame sets counted on")


def test_a_configuration_that_cannot_be_is_refused_with_a_line(daemon: Daemon, game: Game) -> None:
    wait_until(game.is_live, "a person")
    since, changes = len(game.heard), daemon.log.count(TAKEN_UP)
    refusals = daemon.log.count(GOES_ON)
    daemon.configure("smoothing.preset = 'nonsense'")
    daemon.reload()
    daemon.told(GOES_ON, refusals + 1)
    assert "smoothing.preset" in daemon.log.splitlines()[-1]
    daemon.configure("rig = 'nowhere.toml'")
    daemon.reload()
    daemon.told(GOES_ON, refusals + 2)
    daemon.configure()
    taken = len(game.heard)
    wait_until(lambda: len(game.heard) > taken + 30, "more frames")
    connected_throughout(game, since, "refused")
    assert daemon.log.count(TAKEN_UP) == changes


def test_the_command_reload_says_what_became_of_it(daemon: Daemon, game: Game) -> None:
    wait_until(game.is_live, "a person")
    since = len(game.heard)
    daemon.configure("smoothing.preset = 'nonsense'")
    refused = mocapd(daemon.env, "reload")
    assert refused.code == 78
    assert "config.toml" in refused.err
    assert "smoothing.preset" in refused.err
    daemon.configure("smoothing.preset = 'smooth'", "web.port = 1")
    done = mocapd(daemon.env, "reload")
    assert done.code == 0
    assert f"{INSTANCE}: taken up" in done.out
    assert "only for the next start: web" in done.out
    daemon.configure()
    taken = len(game.heard)
    wait_until(lambda: len(game.heard) > taken + 30 and game.is_live(), "the person again")
    connected_throughout(game, since, "mocapd reload")
    told = mocapd(daemon.env, "status", "--json")
    assert told.code in (0, SLOW)  # a busy machine may be
    assert json.loads(told.out)["calibration"]["made_unix_s"] > 0


def test_sigterm_ends_it_in_two_seconds_while_another_session_is_prepared(daemon: Daemon) -> None:
    preparing = daemon.log.count("preparing another session")
    daemon.reload()
    daemon.told("preparing another session", preparing + 1)
    daemon.process.send_signal(signal.SIGTERM)
    end_within(daemon.process, 2.0)
    assert daemon.process.returncode == 0
    assert "Traceback" not in daemon.log
