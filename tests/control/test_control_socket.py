"""The control socket: who may ask, what is answered, and what bytes from outside do to it."""

import json
import multiprocessing
import os
import socket
import stat
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator
from multiprocessing.queues import SimpleQueue
from pathlib import Path
from socketserver import UnixStreamServer

import msgspec
import pytest

from mocapd.config.effective import Effective, load_config
from mocapd.config.runtime_folder import folders_to_look_in, runtime_folder
from mocapd.config.sections import Config
from mocapd.control import target_process
from mocapd.control.control_client import FoundDaemons, RunningDaemon, running_daemons
from mocapd.control.control_messages import Recentered, Reloaded, StatusReport, Verb
from mocapd.control.control_socket import LONGEST_REQUEST, MOST_AT_ONCE, ControlSocket
from mocapd.control.socket_place import (
    closed_folders,
    service_sockets,
    short_address,
    socket_path,
    sockets_in,
)
from mocapd.control.target_process import no_daemon_error, target_daemon
from mocapd.errors import CannotCreateError, ConfigError, MocapdError, UnavailableError
from tests.control.reports import report
from tests.outputs.frames import eventually

NOBODY = 65534


class Answering:
    """A daemon behind a socket: `refusal` is what it says to everything but status."""

    def __init__(self, folder: Path, pid: int = 77) -> None:
        self.refusal: MocapdError | None = None
        self.died: list[BaseException] = []
        self.waits: threading.Event | None = None
        self.path = socket_path(folder, pid)
        self.socket = ControlSocket(self.path, self.answer, self.died.append)

    def answer(self, verb: Verb) -> StatusReport | Recentered | Reloaded:
        if self.waits is not None and verb == "reload":
            self.waits.wait(60.0)
        if verb == "status":
            return report(instance="hall", pid=77)
        if self.refusal is not None:
            raise self.refusal
        return Recentered(12.5, ("osc",)) if verb == "recenter" else Reloaded(0.25, ("zenoh",))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    # longer than an address of a Unix socket may be
    folder = tmp_path / ("a" * 100) / "mocapd"
    folder.mkdir(parents=True)
    return folder


@pytest.fixture
def answering(folder: Path) -> Iterator[Answering]:
    one = Answering(folder)
    one.socket.open()
    yield one
    one.socket.close()
    assert one.died == []


def _hang_up(listening: socket.socket) -> None:
    connection, _address = listening.accept()
    connection.close()


def found(folder: Path) -> FoundDaemons:
    return running_daemons((folder,), services=())


def the_one(folder: Path) -> RunningDaemon:
    (daemon,) = found(folder).daemons
    return daemon


def test_a_command_of_this_user_is_answered(answering: Answering, folder: Path) -> None:
    daemon = the_one(folder)
    assert daemon.status == report(instance="hall", pid=77)
    assert daemon.recenter() == Recentered(12.5, ("osc",))
    assert daemon.reload() == Reloaded(0.25, ("zenoh",))


def test_a_refusal_arrives_as_the_error_it_was(answering: Answering, folder: Path) -> None:
    answering.refusal = ConfigError("no preset 'x'", "config.toml:3: smoothing.preset", "one of: a")
    with pytest.raises(ConfigError) as caught:
        the_one(folder).reload()
    assert str(caught.value) == str(answering.refusal)
    assert caught.value.exit_code == 78


def test_status_is_answered_while_a_reload_takes_its_time(
    answering: Answering, folder: Path
) -> None:
    answering.waits = threading.Event()
    daemon = the_one(folder)
    reloading = threading.Thread(target=daemon.reload)
    reloading.start()
    assert the_one(folder).status.instance == "hall"
    answering.waits.set()
    reloading.join()


def test_the_file_is_for_its_user_alone_and_goes_with_the_daemon(folder: Path) -> None:
    one = Answering(folder)
    before = os.umask(0)
    try:
        one.socket.open()
    finally:
        os.umask(before)
    assert stat.S_IMODE(one.path.stat().st_mode) == 0o600
    one.socket.close()
    assert sockets_in(folder) == ()
    one.socket.close()


def test_what_a_killed_daemon_left_is_removed_and_in_nobodys_way(folder: Path) -> None:
    with socket.socket(socket.AF_UNIX) as left, short_address(socket_path(folder, 77)) as address:
        left.bind(address)
    assert found(folder) == FoundDaemons()
    assert sockets_in(folder) == ()
    with socket.socket(socket.AF_UNIX) as left, short_address(socket_path(folder, 77)) as address:
        left.bind(address)
    one = Answering(folder)
    one.socket.open()
    assert the_one(folder).status.instance == "hall"
    one.socket.close()


def test_who_looks_while_a_daemon_opens_its_socket_does_not_remove_it(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    one = Answering(folder)
    listen = UnixStreamServer.server_activate

    def looked_at(server: UnixStreamServer) -> None:
        assert found(folder) == FoundDaemons()  # it is bound, and does not listen yet
        listen(server)

    monkeypatch.setattr(UnixStreamServer, "server_activate", looked_at)
    one.socket.open()
    assert the_one(folder).status.instance == "hall"
    one.socket.close()
    assert not list(folder.iterdir())


def test_one_that_says_nothing_is_told_apart_from_one_that_is_not_there(folder: Path) -> None:
    path = socket_path(folder, 78)
    with socket.socket(socket.AF_UNIX) as silent:
        with short_address(path) as address:
            silent.bind(address)
        silent.listen()
        answer = threading.Thread(target=lambda: _hang_up(silent))
        answer.start()
        assert found(folder).silent == (path,)
        answer.join()
    assert path.exists()


@pytest.mark.parametrize(
    "sent",
    [
        b"\n",
        b"status\n",
        b"\xff\xfe\n",
        b'{"verb": "halt"}\n',
        b'{"verb": ["status"]}\n',
        b"[" * 3000 + b"\n",
        b"x" * (LONGEST_REQUEST + 1),
        b'{"verb": "status"}',  # and no end of the line
    ],
)
def test_what_is_no_request_is_refused_and_ends_nothing(
    answering: Answering, folder: Path, sent: bytes
) -> None:
    with socket.socket(socket.AF_UNIX) as one:
        with short_address(answering.path) as address:
            one.connect(address)
        one.sendall(sent)
        one.shutdown(socket.SHUT_WR)
        told = json.loads(one.makefile("rb").readline())
    assert told["refused"]["exit_code"] == 66
    assert "not understood" in told["refused"]["what"]
    assert the_one(folder).status.instance == "hall"


def test_a_bug_in_an_answer_ends_the_daemon(folder: Path) -> None:
    one = Answering(folder)
    one.refusal = None
    died: list[BaseException] = []

    def answer(_verb: Verb) -> msgspec.Struct:
        raise ZeroDivisionError

    one.socket = ControlSocket(one.path, answer, died.append)
    one.socket.open()
    with pytest.raises(UnavailableError):
        RunningDaemon(one.path, report()).reload()
    assert eventually(lambda: bool(died))
    assert isinstance(died[0], ZeroDivisionError)
    one.socket.close()


def test_silent_connections_are_bounded_and_let_others_in_again(
    answering: Answering, folder: Path
) -> None:
    opened = [socket.socket(socket.AF_UNIX) for _ in range(MOST_AT_ONCE)]
    for one in opened:
        with short_address(answering.path) as address:
            one.connect(address)
    assert eventually(lambda: bool(found(folder).silent))
    for one in opened:
        one.close()
    assert eventually(lambda: bool(found(folder).daemons))


def test_a_folder_that_cannot_be_made_is_a_named_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    one = Answering(tmp_path / "file" / "run")
    with pytest.raises(CannotCreateError, match="XDG_RUNTIME_DIR"):
        one.socket.open()


def test_a_daemon_of_a_session_is_found_from_outside_of_one_and_the_other_way_round(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    session = tmp_path / "sessions" / str(os.geteuid())
    for name in ("RUNTIME_DIRECTORY", "XDG_RUNTIME_DIR"):
        monkeypatch.delenv(name, raising=False)
    of_cron = Answering(runtime_folder(tmp_path / "state"), 1)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(session))
    of_session = Answering(runtime_folder(tmp_path / "state"), 2)
    for one in (of_cron, of_session):
        one.socket.open()
    for outside in (False, True):
        if outside:
            monkeypatch.delenv("XDG_RUNTIME_DIR")
        folders = folders_to_look_in(tmp_path / "state", tmp_path / "sessions")
        assert {one.path for one in running_daemons(folders, services=()).daemons} == {
            of_cron.path,
            of_session.path,
        }
    for one in (of_cron, of_session):
        one.socket.close()


def test_the_sockets_of_services_are_found_by_root(tmp_path: Path) -> None:
    for name in ("mocapd", "mocapd-left", "mocapd/right", "other"):
        (tmp_path / name).mkdir(parents=True)
        (tmp_path / name / "control-5.sock").write_text("")
    names = {str(path.parent.relative_to(tmp_path)) for path in service_sockets(tmp_path)}
    assert names == {"mocapd", "mocapd-left", "mocapd/right"}


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can be another user")
def test_another_user_is_refused_and_logged_once_even_where_the_file_would_let_it_in(
    answering: Answering, caplog: pytest.LogCaptureFixture
) -> None:
    answering.path.chmod(0o666)
    for _ in range(2):
        assert json.loads(_asked_by(NOBODY, answering.path))["refused"]["exit_code"] == 77
    assert caplog.text.count(f"user {NOBODY} asked") == 1


_ASK = """
import os, socket, sys
os.chdir(sys.argv[2])
os.setuid(int(sys.argv[1]))
with socket.socket(socket.AF_UNIX) as one:
    one.connect(sys.argv[3])
    try:
        one.sendall(b'{"verb": "reload"}\\n')
    except BrokenPipeError:
        pass  # it is refused before it has said anything
    sys.stdout.buffer.write(one.recv(1 << 16))
"""


def _asked_by(uid: int, path: Path) -> str:
    """What a process is answered that is this user's once it runs, as that user may not read any file of Python."""
    words = (sys.executable, "-c", _ASK, str(uid), str(path.parent), path.name)
    return subprocess.run(words, capture_output=True, text=True, timeout=60, check=True).stdout


def _seen_by_nobody(folder: Path, told: "SimpleQueue[list[str]]") -> None:
    os.setuid(NOBODY)
    told.put([one.name for one in closed_folders(folder)])
    told.put([one.name for one in service_sockets(folder)])


@pytest.mark.skipif(os.geteuid() != 0, reason="only root may become somebody else")
def test_a_service_is_known_to_run_by_those_who_may_not_look_into_its_folder() -> None:
    """Else `mocapd status` would say that nothing runs, and how to start another."""
    fork = multiprocessing.get_context("fork")
    told = fork.SimpleQueue()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        folder.chmod(0o755)
        for place in ("private/mocapd", "mocapd-rigs/hall", "mocapd-own", "other"):
            (folder / place).mkdir(parents=True)
        (folder / "mocapd").symlink_to("private/mocapd")
        (folder / "mocapd-own/control-12.sock").touch()
        for place in ("private", "mocapd-rigs/hall", "other"):
            (folder / place).chmod(0o700)
        assert closed_folders(folder) == ()  # root may look everywhere
        child = fork.Process(target=_seen_by_nobody, args=(folder, told))
        child.start()
        child.join()
    assert told.get() == ["mocapd", "hall"]
    assert told.get() == ["control-12.sock"]  # of one beside them that is open


def test_what_is_said_of_it() -> None:
    refused = no_daemon_error(FoundDaemons(foreign=(Path("/run/mocapd"),)), Config())
    assert str(refused) == "/run/mocapd: a daemon of another user is running -- ask with sudo"


def test_while_ones_own_daemon_hangs_no_other_one_is_commanded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    other = RunningDaemon(tmp_path / "control-2.sock", report(instance="hall", state_dir="/else"))
    found = FoundDaemons((other,), (tmp_path / "control-1.sock",))
    monkeypatch.setattr(target_process, "find_daemons", lambda _: found)
    with pytest.raises(UnavailableError, match=r"control-1\.sock: runs, but does not answer"):
        target_daemon(of_flags(state_dir=str(tmp_path)))
    assert target_daemon(of_flags(state_dir=str(tmp_path), instance="hall")) is other
    assert target_daemon(of_flags(state_dir="/else")) is other


def of_flags(**flags: str) -> Effective:
    return load_config(flags, env={}, candidates=())
