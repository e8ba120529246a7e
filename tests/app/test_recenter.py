"""`mocapd recenter` to a running service: VRChat is turned once, and the command says what was done."""

import socket
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import pytest

from mocapd.cli.recenter import recenter
from mocapd.config.runtime_folder import runtime_folder
from mocapd.config.sections import Config
from mocapd.control.daemon_control import DaemonControl
from mocapd.control.last_trouble import LastTrouble
from mocapd.control.reloads import Reloads
from mocapd.control.socket_place import socket_path
from mocapd.errors import UnavailableError
from mocapd.outputs.output_table import OscSection, VRChatSection
from mocapd.service.open_outputs import OpenOutputs
from mocapd.service.service import Service
from tests.outputs.frames import eventually
from tests.outputs.receivers.vrchat import VRChatReceiver
from tests.service.test_service import session_of


class Listening:
    """A VRChat on a socket, read when it is asked."""

    def __init__(self) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.socket.settimeout(30.0)
        self.vrchat = VRChatReceiver(hmd_yaw_deg=40.0)
        self.addresses: list[str] = []
        self.frames = 0

    @property
    def destination(self) -> str:
        host, port = self.socket.getsockname()
        return f"{host}:{port}"

    def hear(self) -> bool:
        self.frames += 1
        self.addresses += self.vrchat.take(self.socket.recv(2000), self.frames / 30.0)
        return "/tracking/trackers/head/rotation" in self.addresses


@contextmanager
def controlled(service: Service, pid: int) -> Iterator[None]:
    """The service as a daemon of that number."""
    path = socket_path(runtime_folder(service.config.state_dir), pid)
    outputs = OpenOutputs(service.config)
    with DaemonControl(path, service.config, outputs, LastTrouble()) as control:
        control.open()
        control.attach(service, Reloads())
        yield


@pytest.fixture
def listening(empty_home: Path) -> Iterator[Listening]:
    one = Listening()
    yield one
    one.socket.close()


def test_it_turns_vrchat_once(
    listening: Listening, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    section = VRChatSection(listening.destination, enabled=True)
    osc = OscSection(("127.0.0.1:9",), enabled=True)  # has no message for the forward direction
    config = Config(outputs={"osc": osc, "vrchat": section}, state_dir=tmp_path, instance="game")
    with Service(config, session_of("a")) as service, controlled(service, 1):
        for _ in range(5):
            assert not listening.hear()
        recenter()
        assert eventually(listening.hear)
        out = capsys.readouterr()
        assert out.out.endswith("told to: vrchat\n")
        assert out.err == ""
        for _ in range(10):
            listening.hear()
        assert listening.addresses.count("/tracking/trackers/head/rotation") == 1
        assert (listening.vrchat.snaps, listening.vrchat.slerps) == (1, 0)
        assert listening.vrchat.yaw_deg == pytest.approx(40.0)

        # a second daemon beside it, which sends to nobody
        other_config = replace(config, outputs={}, instance="cave")
        with Service(other_config, session_of("b")) as other, controlled(other, 2):
            assert eventually(lambda: other.snapshot().metrics.published > 0)
            recenter(settings=["instance=cave"])
    assert "vrchat.enabled = true" in capsys.readouterr().err


def test_without_a_daemon_it_says_so(listening: Listening) -> None:
    with pytest.raises(UnavailableError, match=r"no mocapd of yours is running.*mocapd run"):
        recenter()
