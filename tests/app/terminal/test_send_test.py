"""`mocapd send-test`: to whatever output there is, and whether anybody listens."""

import json
import re
import socket
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np
import pytest
import typer
import zenoh

from mocapd.app.terminal import logs
from mocapd.app.terminal.send_test_run import is_heard, outcome
from mocapd.app.terminal.waving_person import LOOP, waving_person
from mocapd.body.shape import mean_shape
from mocapd.body.skeleton import INDEX
from mocapd.cli.send_test import send_test_command
from mocapd.clock import nanoseconds
from mocapd.errors import UnavailableError, UsageError
from mocapd.outputs import output_table, wire
from mocapd.outputs.address_override import resolve_host
from mocapd.outputs.base import SinkStatus
from mocapd.outputs.osc.osc_sink import Destination, status_of
from mocapd.outputs.output_table import (
    OUTPUTS,
    OscSection,
    OutputEntry,
    VRChatSection,
    ZenohSection,
)
from mocapd.types import Floats
from tests.outputs.frames import free_port
from tests.outputs.receivers.typed_osc import decoded
from tests.outputs.receivers.vrchat import VRChatReceiver
from tests.outputs.vmc.vrm_models import model, write_vrm
from tests.service.test_publisher import Recorder


class Command(Protocol):
    """Runs it; its exit code."""

    def __call__(
        self,
        *,
        output: str,
        port: int | None = None,
        seconds: float = 0.3,
        host: str | None = None,
        vrm: Path | None = None,
    ) -> int: ...


@pytest.fixture
def code_of(monkeypatch: pytest.MonkeyPatch, empty_home: Path) -> Command:
    """The command of a user with an empty home."""
    monkeypatch.setattr(logs, "set_up_logs", lambda _level: None)  # it is for a whole process

    def run(
        *,
        output: str,
        port: int | None = None,
        seconds: float = 0.3,
        host: str | None = None,
        vrm: Path | None = None,
    ) -> int:
        with pytest.raises(typer.Exit) as ended:
            send_test_command(output=output, port=port, seconds=seconds, host=host, vrm=vrm)
        return ended.value.exit_code

    return run


@pytest.fixture
def listening() -> Iterator[socket.socket]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        one.settimeout(30.0)
        yield one


@pytest.mark.parametrize(("output", "seconds"), [("osc", 1.2), ("vrchat", 0.2), ("vmt", 0.2)])
def test_a_listener_gets_it_and_the_code_is_0(
    code_of: Command,
    output: str,
    seconds: float,
    listening: socket.socket,
    capsys: pytest.CaptureFixture[str],
) -> None:
    port = listening.getsockname()[1]
    assert code_of(output=output, port=port, host="localhost", seconds=seconds) == 0
    out = capsys.readouterr()
    assert f"{output}: " in out.out
    assert f"receiver on 127.0.0.1:{port}" in out.out
    assert ("1 of 1.2 s: receiver on" in out.err) is (seconds > 1.0)
    assert listening.recv(2000).startswith(b"#bundle\0")


def test_an_avatar_gets_its_own_bones_from_a_sender_that_is_calibrated(
    code_of: Command, listening: socket.socket, tmp_path: Path
) -> None:
    avatar = model()
    path = write_vrm(tmp_path / "me.vrm", avatar)
    port = listening.getsockname()[1]
    assert code_of(output="vmc", port=port, host="localhost", seconds=0.2, vrm=path) == 0
    sent = {
        (message.address, message.values[0].value): [value.value for value in message.values]
        for message in decoded(listening.recv(2000))
    }
    assert sent["/VMC/Ext/OK", 1] == [1, 3, 0, 1]
    arm = sent["/VMC/Ext/Bone/Pos", "LeftLowerArm"]
    assert arm[1:4] == pytest.approx(avatar.in_unity()["leftLowerArm"].at, abs=1e-6)


@pytest.mark.parametrize("output", ["zenoh", "osc", "vrchat", "vmt"])
def test_where_nobody_listens_it_says_so_and_the_code_is_1(
    code_of: Command, output: str, capsys: pytest.CaptureFixture[str]
) -> None:
    kind = socket.SOCK_STREAM if output == "zenoh" else socket.SOCK_DGRAM
    assert code_of(output=output, port=free_port(kind)) == 1
    assert "nobody listens" in capsys.readouterr().out


def test_the_frames_of_several_destinations_are_counted_together(
    code_of: Command,
    listening: socket.socket,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    there = f"127.0.0.1:{listening.getsockname()[1]}"
    monkeypatch.setenv("MOCAPD_OSC_DESTINATIONS", f'["{there}", "{there}"]')
    assert code_of(output="osc") == 0
    sent, wanted = re.findall(r"\d+", capsys.readouterr().out)[:2]
    assert sent == wanted


def test_each_destination_says_whether_it_got_it_and_how_that_is_known(
    code_of: Command,
    listening: socket.socket,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    here = f"127.0.0.1:{listening.getsockname()[1]}"
    closed = f"127.0.0.1:{free_port(socket.SOCK_DGRAM)}"
    refusing = f"no receiver on {closed} (its port refused the frames)"
    monkeypatch.setenv("MOCAPD_OSC_DESTINATIONS", f'["{here}", "{closed}"]')
    assert code_of(output="osc") == 0
    assert f": receiver on {here}; {refusing}\n" in capsys.readouterr().out
    destinations = Destination(closed), Destination(here)
    destinations[1].is_local = False
    for _ in range(3):
        for destination in destinations:
            destination.send([bytearray(b"x")])
    status = status_of(destinations)
    assert status.listeners == -1, "another machine is not nobody"
    assert outcome(status, heard=False) == (
        f"nobody is known to listen ({refusing}; sending to {here} (whether anybody listens there is not told))"
    )
    for destination in destinations:
        destination.close()


def test_a_subscriber_gets_it_over_zenoh(code_of: Command) -> None:
    """At a router, which is there before."""
    port = free_port()
    config = {
        "mode": "router",
        "listen": {"endpoints": [f"tcp/127.0.0.1:{port}"]},
        "scouting": {"multicast": {"enabled": False}},
    }
    with (
        zenoh.open(zenoh.Config.from_json5(json.dumps(config))) as router,
        router.declare_subscriber("mocapd/v1/*/skeleton/0") as frames,
    ):
        assert code_of(output="zenoh", host="127.0.0.1", port=port, seconds=1.0) == 0
        sample = frames.try_recv()
        assert sample is not None
        assert wire.decode(sample.payload.to_bytes(), str(sample.encoding)).tracking == "live"


def test_an_output_that_is_new_in_the_table_can_be_tried(
    code_of: Command, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    @dataclass(frozen=True)
    class Section:
        """destinations: where"""

        destinations: tuple[str, ...] = ("127.0.0.1:39539", "127.0.0.1:39549")
        enabled: bool = False

    class NewSink(Recorder):
        def status(self) -> SinkStatus:
            return SinkStatus(len(self.frames), 0, -1, "sending to it")

    seen: list[Section] = []

    def build(section: Section, _instance: str) -> Recorder:
        seen.append(section)
        return NewSink()

    monkeypatch.setattr(output_table, "OUTPUTS", {**OUTPUTS, "new": OutputEntry(Section, build)})
    assert code_of(output="new", port=39600) == 0
    assert seen == [Section(("127.0.0.1:39600",))]
    assert "sending to it (whether anybody listens there is not told)" in capsys.readouterr().out


def test_what_cannot_be_is_a_named_error(code_of: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(UsageError, match=r"no output 'vcm'.*one of: .*vrchat"):
        code_of(output="vcm")

    def unknown(*_: object, **__: object) -> None:
        raise socket.gaierror(socket.EAI_NONAME, "Name or service not known")

    monkeypatch.setattr(socket, "getaddrinfo", unknown)
    with pytest.raises(UnavailableError, match=r"--host.*'quest'.*not known"):
        code_of(output="vrchat", host="quest")
    with pytest.raises(UnavailableError, match=r"--host.*'quest'.*not known"):
        code_of(output="zenoh", host="quest")


def test_a_name_is_looked_up_once_and_ipv4_preferred(monkeypatch: pytest.MonkeyPatch) -> None:
    both = [
        (socket.AF_INET6, socket.SOCK_DGRAM, 17, "", ("fd00::7", 0, 0, 0)),
        (socket.AF_INET, socket.SOCK_DGRAM, 17, "", ("192.168.1.7", 0)),
    ]
    monkeypatch.setattr(socket, "getaddrinfo", lambda *_, **__: both)
    assert resolve_host("quest") == "192.168.1.7"
    assert resolve_host("10.0.0.3") == "10.0.0.3"
    monkeypatch.undo()
    with pytest.raises(UnavailableError, match="has no address"):
        resolve_host("a" * 70 + "." * 2)


@pytest.mark.parametrize(
    ("output", "section", "host", "port", "expected"),
    [
        ("osc", OscSection(), "10.0.0.2", None, {"destinations": ("10.0.0.2:39541",)}),
        ("osc", OscSection(()), None, 5, {"destinations": ("127.0.0.1:5",)}),
        ("osc", OscSection(("[::1]:7",)), None, 5, {"destinations": ("[::1]:5",)}),
        ("vrchat", VRChatSection("auto"), "10.0.0.2", None, {"destination": "10.0.0.2:9000"}),
        ("vrchat", VRChatSection(), "fd00::7", 9, {"destination": "[fd00::7]:9"}),
        ("zenoh", ZenohSection(connect=("tcp/1.2.3.4:1",)), None, 5, {"port": 5, "connect": ()}),
        ("zenoh", ZenohSection(), "10.0.0.2", None, {"connect": ("tcp/10.0.0.2:7447",)}),
        (
            "zenoh",
            ZenohSection(connect=("tls/hub:7450#iface=eth0", "tcp/hub:7447")),
            "localhost",  # not its address: its certificate is for the name
            None,
            {"connect": ("tls/localhost:7450",)},
        ),
        (
            "zenoh",
            ZenohSection(listen=("tcp/127.0.0.1:1",)),
            "10.0.0.2",
            5,
            {"listen": (), "connect": ("tcp/10.0.0.2:5",)},
        ),
    ],
)
def test_host_and_port_take_the_place_of_what_is_configured(
    output: str,
    section: object,
    host: str | None,
    port: int | None,
    expected: dict[str, object],
) -> None:
    aimed = OUTPUTS[output].override_address(section, host, port)
    assert {name: getattr(aimed, name) for name in expected} == expected


@pytest.mark.parametrize(
    ("listeners", "sent", "refused_before", "refused", "expected"),
    [(1, 9, 3, 3, True), (0, 9, 0, 0, False), (-1, 9, 3, 3, True), (-1, 9, 3, 4, False), (-1, 0, 0, 0, False)],
)  # fmt: skip
def test_other_machines_are_believed_while_nobody_refuses(
    listeners: int, sent: int, refused_before: int, refused: int, expected: bool
) -> None:
    halfway = SinkStatus(sent, refused_before, listeners, "")
    assert is_heard(SinkStatus(sent, refused, listeners, ""), halfway) is expected


def joint_m(name: str, at_s: float) -> Floats:
    body = waving_person(mean_shape(1.75), nanoseconds(at_s), 0).body
    assert body.joints_m is not None
    joint: Floats = body.joints_m[INDEX[name]]
    return joint


def test_the_person_waves_the_left_hand_and_steps_left_first() -> None:
    quarter_s = 0.25 * LOOP.loop_s
    assert joint_m("hips", quarter_s)[0] > joint_m("hips", 0.0)[0] + 0.2
    assert joint_m("hips", 3 * quarter_s)[0] < joint_m("hips", 0.0)[0] - 0.2
    # the foot that goes ahead is lifted
    assert joint_m("leftFoot", 0.1)[1] > joint_m("rightFoot", 0.1)[1] + 0.05
    assert joint_m("rightFoot", 2 * quarter_s)[1] > joint_m("leftFoot", 2 * quarter_s)[1] + 0.05
    times_s = np.linspace(0.0, quarter_s, 40)
    assert np.ptp([joint_m("leftHand", t)[1] for t in times_s]) > 0.05
    assert all(joint_m("leftHand", t)[1] > joint_m("rightHand", t)[1] + 0.2 for t in times_s)


def test_what_vrchat_gets_is_what_a_strict_vrchat_reads(
    code_of: Command, listening: socket.socket
) -> None:
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 20)
    assert code_of(output="vrchat", port=listening.getsockname()[1]) == 0
    vrchat = VRChatReceiver()
    for number in range(3):
        assert len(vrchat.take(listening.recv(2000), number / 60.0)) == 7
    assert vrchat.in_world(2).position_m[1] > vrchat.in_world(3).position_m[1]
