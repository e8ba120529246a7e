"""`mocapd status` and `mocapd reload`: what is printed, and the exit code that a script asks for."""

import json
import os
from collections.abc import Callable, Iterator
from pathlib import Path

import msgspec
import pytest

from mocapd.app.terminal.status_text import duration, status_lines
from mocapd.config.runtime_folder import runtime_folder
from mocapd.control.control_messages import Recentered, Reloaded, StatusReport, Trouble, Verb
from mocapd.control.control_socket import ControlSocket
from mocapd.control.socket_place import service_sockets, socket_path
from mocapd.errors import ConfigError
from tests.cli.mocapd_process import Outcome, mocapd_here
from tests.control.reports import CAMERA, report

Serve = Callable[[StatusReport], None]


@pytest.fixture
def say(empty_home: Path) -> Callable[..., Outcome]:
    return lambda *words: mocapd_here(dict(os.environ), *words)


@pytest.fixture
def serve(empty_home: Path) -> Iterator[Serve]:
    """Daemons that answer: reload is refused by those without a state."""
    opened: list[ControlSocket] = []

    def one_more(told: StatusReport) -> None:
        def answer(verb: Verb) -> StatusReport | Recentered | Reloaded:
            if verb == "status":
                return told
            if told.state == "blind":
                raise ConfigError("no preset 'x'", "config.toml:3: smoothing.preset", "one of: off")
            return Reloaded(0.25, ("zenoh",))

        path = socket_path(runtime_folder(empty_home), told.pid)
        opened.append(ControlSocket(path, answer, lambda error: None))
        opened[-1].open()

    yield one_more
    for one in opened:
        one.close()


def test_without_a_daemon_the_code_is_that_of_a_stopped_service(
    say: Callable[..., Outcome],
) -> None:
    if service_sockets():
        pytest.skip("a mocapd of this machine is running")
    done = say("status")
    assert (done.code, done.out) == (3, "")
    assert "no mocapd of yours is running" in done.err
    assert say("reload").code == 69


@pytest.mark.parametrize(
    ("state", "code"), [("tracking", 0), ("nobody", 0), ("starting", 150), ("blind", 150)]
)
def test_the_code_says_whether_it_can_track(
    say: Callable[..., Outcome], serve: Serve, state: str, code: int
) -> None:
    serve(report(state=state))
    done = say("status", "--json")
    assert done.code == code
    assert json.loads(done.out)["state"] == state
    assert json.loads(done.out)["schema"] == "mocapd.Status.v1"
    assert say("status").code == code


def test_of_several_the_one_that_is_named_else_all(
    say: Callable[..., Outcome], serve: Serve
) -> None:
    serve(report(instance="left", pid=1))
    serve(report(instance="right", pid=2, state="blind"))
    both = say("status", "--json")
    assert [json.loads(line)["instance"] for line in both.out.splitlines()] == ["left", "right"]
    assert both.code == 150
    one = say("status", "--json", "--set", "instance=left")
    assert json.loads(one.out)["instance"] == "left"
    assert one.code == 0
    assert say("reload").code == 78
    assert "choose by --set instance=NAME" in say("reload").err


def test_a_name_that_no_daemon_has_addresses_none(
    say: Callable[..., Outcome], serve: Serve, tmp_path: Path
) -> None:
    serve(report(instance="left", pid=1))
    for command, code in (("status", 3), ("reload", 69), ("recenter", 69)):
        refused = say(command, "--set", "instance=lfet")
        assert (refused.code, refused.out) == (code, "")
        assert "no mocapd of yours named 'lfet' is running" in refused.err
        assert "choose one that is: left" in refused.err
    # a daemon keeps the name that it started with, whatever its file says since
    file = tmp_path / "config.toml"
    file.write_text("instance = 'renamed'\n")
    assert say("reload", "--config", str(file)).code == 0


def test_a_configuration_that_was_broken_since_hides_no_running_daemon(
    say: Callable[..., Outcome], serve: Serve, tmp_path: Path
) -> None:
    serve(report(instance="left", pid=1))
    file = tmp_path / "config.toml"
    file.write_text("smoothing.preset = 'nonsense'\n")
    done = say("status", "--config", str(file), "--json")
    assert done.code == 0
    assert json.loads(done.out)["instance"] == "left"
    assert "the next start or reload will not do" in done.err
    assert "smoothing.preset" in done.err
    assert say("reload", "--config", str(file)).code == 0  # it reads its own
    assert say("status", "--set", "instance").code == 2


def test_a_reload_says_what_waits_and_a_refusal_names_the_key(
    say: Callable[..., Outcome], serve: Serve
) -> None:
    serve(report(instance="left", pid=1))
    serve(report(instance="right", pid=2, state="blind"))
    done = say("reload", "--set", "instance=left")
    assert done.code == 0
    assert "0.25 s without a frame" in done.out
    assert "only for the next start: zenoh" in done.out
    done = say("reload", "--set", "instance=right")
    assert done.code == 78
    assert "smoothing.preset: no preset 'x' -- one of: off" in done.err


def test_what_a_daemon_answers_gives_the_terminal_no_orders(
    say: Callable[..., Outcome], serve: Serve
) -> None:
    """A service that was broken into is asked by root."""
    serve(report(instance="\x1b]0;owned\x07", pid=1))
    for command in ("reload", "doctor"):
        assert "owned" in (told := say(command).out)
        assert "\x1b" not in told


def test_every_line_has_what_it_is_about() -> None:
    lost = CAMERA.__class__(
        "right", "lost", "unplugged", "usb:1-4:046d:0825:", 0.0, 50, 3, 2, "bumped"
    )
    told = report(
        cameras=(CAMERA, lost), last_trouble=Trouble(1_000_000.0, "warning", "right: lost")
    )
    text = "\n".join(status_lines(told, 1_000_000.0 + 3 * 86400 + 60))
    assert "up 3 h 12 min" in text
    assert "30.0 Hz, latency 21 ms (p95 34), 990 frames, 10 dropped" in text
    assert "3 days old" in text
    assert (
        "lost, unplugged, bumped: calibrate the room again, 3 lost frames, 2 times reopened" in text
    )
    again = CAMERA.__class__("left", "live", "", "usb:1-5:046d:0825:", 30.0, 50, 1, 1, "")
    assert (
        "live 30.0 Hz, 1 lost frame, 1 time reopened" in status_lines(report(cameras=(again,)))[4]
    )
    assert "1 listening, 990 sent, 10 not: game (pid 12)" in text
    assert "3 d 0 h ago: right: lost" in text


def test_who_is_not_taken_for_a_person_is_not_called_nobody() -> None:
    told = report(state="nobody", tracking="lost", lost_reason="somebody moves -- stand up once")
    (line,) = [one for one in status_lines(told, 0.0) if one.startswith("state")]
    assert "nobody is tracked: somebody moves -- stand up once" in line
    assert "nobody in view" in "\n".join(status_lines(report(state="nobody"), 0.0))


def test_less_effort_is_said_with_what_can_be_done() -> None:
    lines = [one for one in status_lines(report(effort="least"), 0.0) if one.startswith("effort")]
    assert "least effort: this machine is much too slow" in lines[0]
    assert "close other programs" in lines[0]
    for other in (
        report(),
        report(effort="least", state="blind"),
    ):  # no machine is too slow for no pictures
        assert not any(one.startswith("effort") for one in status_lines(other, 0.0))


def test_what_others_have_named_is_told_in_one_line() -> None:
    """Of a camera node's reason, or of a webcam's serial number, a terminal is to obey nothing."""
    odd = msgspec.structs.replace(CAMERA, detail="\x1b]0;owned\x07\nstate  tracking")
    lines = status_lines(report(cameras=(odd,)), 0.0)
    assert all(line.isprintable() for line in lines)
    assert str(ConfigError("a\nb", "\x1b[2J", "c\td")) == " [2J: a b -- c d"


@pytest.mark.parametrize(
    ("span_s", "text"),
    [(0.0, "0 s"), (61.0, "1 min 1 s"), (7200.0, "2 h 0 min"), (90_000.0, "1 d 1 h"), (-5, "0 s")],
)
def test_a_duration_has_its_two_largest_units(span_s: float, text: str) -> None:
    assert duration(span_s) == text
