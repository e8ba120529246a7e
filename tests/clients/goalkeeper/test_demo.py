"""The demo: simulated cameras and shooter follow one script."""

import os
import pty
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest

from goalkeeper.app.headless import play_headless
from goalkeeper.streams import demo_daemon
from goalkeeper.streams.demo_daemon import DAEMON, DemoStream, daemon_program
from goalkeeper.streams.demo_script import SCRIPT, demo_scenario, scenario_toml
from goalkeeper.streams.person_stream import PersonStream
from goalkeeper.streams.scripted_shooter import ScriptedShooter
from mocapd.errors import CannotCreateError, UnavailableError
from mocapd.sim.scenario import load_scenario
from tests.outputs.frames import eventually
from tests.processes import still_runs

_PREPARES = (
    "import time; print('pose database: 34 %, film: 5 %, 12 s so far', file=sys.stderr, flush=True); "
    "time.sleep(600)"
)
_PLAYER = (
    "import sys\n"
    "from pathlib import Path\n"
    "from goalkeeper.app.end_signals import end_on_signals\n"
    "from goalkeeper.streams.demo_daemon import DemoStream\n"
    "end_on_signals()\n"
    "stream = DemoStream(Path(sys.argv[1]))\n"
    "print(stream.process.pid, flush=True)\n"
    "sys.stdin.readline()\n"
)


def test_the_cameras_read_the_scenario_as_it_was_written(tmp_path: Path) -> None:
    path = tmp_path / "goalkeeper.toml"
    path.write_text(scenario_toml(demo_scenario()))
    assert load_scenario(path) == demo_scenario()


def test_she_saves_what_she_reaches_for_and_not_where_the_script_says_that_she_is_wrong() -> None:
    report = play_headless(
        PersonStream(demo_scenario(), rate_hz=30.0, latency_s=0.05), ScriptedShooter(), 12, 120.0
    )
    wrong = sum(one.miss_m != (0.0, 0.0) for one in SCRIPT)
    assert report.score.goals in (wrong - 1, wrong, wrong + 1)
    assert report.score.saves == 12 - report.score.goals
    assert {shot.limb for shot in report.shots} >= {"left hand", "right hand"}


def test_a_folder_that_cannot_be_written_is_said(tmp_path: Path) -> None:
    (tmp_path / "cache").write_text("a file in its place")
    with pytest.raises(CannotCreateError, match=r"goalkeeper\.toml"):
        DemoStream(tmp_path / "cache")


def test_the_daemon_is_of_this_environment_else_the_command_that_is_installed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert daemon_program() == DAEMON
    monkeypatch.setattr(demo_daemon, "find_spec", lambda _: None)
    monkeypatch.setattr("shutil.which", lambda _: "/opt/mocapd/bin/mocapd")
    assert "execv('/opt/mocapd/bin/mocapd'" in daemon_program()
    monkeypatch.setattr("shutil.which", lambda _: None)
    with pytest.raises(UnavailableError, match="small install"):
        daemon_program()


def test_what_the_daemon_prepares_is_said_with_time_and_share(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    stream = DemoStream(tmp_path, _PREPARES)
    try:
        first = stream.state().trouble
        assert first.startswith("Preparing the demo: ")
        assert first.endswith(" s so far")
        assert eventually(lambda: ": pose database 34 %, film 5 %, " in stream.state().trouble)
        assert not stream.state().ended
    finally:
        stream.close()
    assert stream.process.poll() is not None
    assert "pose database: 34 %" in capsys.readouterr().err  # the terminal has it, too


def _begun(line: str) -> list[int]:
    """The daemon whose number the player printed, and what it has started."""
    daemon = psutil.Process(int(line))
    assert eventually(lambda: bool(daemon.children(recursive=True)))
    return [daemon.pid, *(child.pid for child in daemon.children(recursive=True))]


def _all_end(begun: list[int], how: str) -> bool:
    """Within 5 s; prints when (`pytest -s`)."""
    ended_s = time.monotonic()
    end = eventually(lambda: not any(map(still_runs, begun)), 5.0)
    left = sum(map(still_runs, begun))
    print(f"{how}: {left} of {len(begun)} left after {time.monotonic() - ended_s:.1f} s")
    return end


@pytest.fixture
def first_start(tmp_path: Path) -> tuple[list[str], dict[str, str]]:
    """The command and the environment of a player whose daemon compiles and renders."""
    env = {name: value for name, value in os.environ.items() if not name.startswith("MOCAPD_")}
    env |= {"XDG_CACHE_HOME": str(tmp_path), "PYTHONPATH": os.pathsep.join(sys.path)}
    return [sys.executable, "-c", _PLAYER, str(tmp_path)], env


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_the_real_daemon_and_what_it_started_end_with_the_game(
    first_start: tuple[list[str], dict[str, str]], number: signal.Signals
) -> None:
    command, env = first_start
    with subprocess.Popen(
        command, env=env, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    ) as player:  # fmt: skip
        assert player.stdout is not None
        begun = _begun(player.stdout.readline())
        player.send_signal(number)
        player.wait()
        assert _all_end(begun, number.name)


def test_they_end_with_the_terminal_of_the_game(
    first_start: tuple[list[str], dict[str, str]],
) -> None:
    command, env = first_start
    player, terminal = pty.fork()
    if player == 0:
        os.execve(command[0], command, env)
    with open(terminal, encoding="utf-8", errors="replace", closefd=False) as said:
        begun = _begun(next(line for line in said if line.strip().isdecimal()))
    os.close(terminal)
    os.waitpid(player, 0)
    assert _all_end(begun, "closed terminal")
