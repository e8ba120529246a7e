"""The VMC sink against real UDP sockets, from its configuration to the strict receivers."""

import socket
from collections.abc import Iterator, Mapping
from contextlib import ExitStack

import msgspec
import numpy as np
import pytest

from mocapd.clock import NS_PER_S
from mocapd.config.effective import load_config
from mocapd.errors import ConfigError, UnavailableError
from mocapd.outputs.messages import CalibratedCamera, CalibrationInfo
from mocapd.outputs.output_table import OutputSection, VmcSection, build_sinks
from mocapd.outputs.vmc.vmc_params import Params
from mocapd.outputs.vmc.vmc_sink import T_PERIOD_S, VmcSink
from tests.golden import stepping_left
from tests.outputs.frames import free_port
from tests.outputs.receivers.evmc4u import Evmc4u
from tests.outputs.receivers.godot_xr_vmc_tracker import GodotXrVmcTracker
from tests.outputs.receivers.typed_osc import decoded
from tests.outputs.vmc.posed_by import greatest_error_m, posed

FRAME, REST = stepping_left.frame(), stepping_left.rest()
CAMERA = CalibratedCamera("left", (640, 480), (0.0,) * 9, (0.0,) * 5, (0.0,) * 9, (0.0,) * 3)
TRUTH = {name: np.array(joint.p) for name, joint in FRAME.joints.items()}


class Clock:
    """Goes on by itself, by a step at each look."""

    def __init__(self, step_ns: int = NS_PER_S // 30) -> None:
        self.now_ns, self.step_ns = 1000 * NS_PER_S, step_ns

    def __call__(self) -> int:
        self.now_ns += self.step_ns
        return self.now_ns


@pytest.fixture
def sockets() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


def receiver(stack: ExitStack, port: int) -> socket.socket:
    listening = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
    listening.bind(("127.0.0.1", port))
    listening.settimeout(5.0)
    return listening


def running(stack: ExitStack, params: Params, clock: Clock | None = None) -> VmcSink:
    sink = VmcSink(params, clock or Clock())
    stack.callback(sink.close)
    sink.send_state(REST)  # also before it is open
    sink.open()
    return sink


def to(*ports: int, **settings: object) -> Params:
    return Params(tuple(f"127.0.0.1:{port}" for port in ports), **settings)  # type: ignore[arg-type]


def values(datagram: bytes, address: str) -> list[object]:
    (one,) = [one for one in decoded(datagram) if one.address == address]
    return [value.value for value in one.values]


def test_from_the_socket_to_the_receivers_the_person_is_where_they_stood(
    sockets: ExitStack,
) -> None:
    port = free_port(socket.SOCK_DGRAM)
    listening = receiver(sockets, port)
    sink = running(sockets, to(port))
    for _ in range(3):
        sink.send(FRAME)
    received = [listening.recvfrom(2000) for _ in range(6)]
    assert greatest_error_m(posed(Evmc4u(), [data for data, _ in received]), TRUTH) < 0.001
    godot = GodotXrVmcTracker()
    for data, (host, number) in received:
        godot.receive(data, (host, number))
    assert greatest_error_m(posed(godot, ()), TRUTH) < 0.001
    assert godot.poses == 6
    status = sink.status()
    assert (status.sent, status.refused, status.listeners) == (3, 0, 1)
    assert status.detail == f"receiver on 127.0.0.1:{port}"


def test_one_socket_for_life_whatever_is_sent(sockets: ExitStack) -> None:
    port = free_port(socket.SOCK_DGRAM)
    listening = receiver(sockets, port)
    sink = running(sockets, to(port, bundle="one"))
    lost = msgspec.structs.replace(FRAME, tracking="lost", joints={})
    for frame in (lost, FRAME, lost, FRAME):
        sink.send(frame)
        sink.send_state(msgspec.structs.replace(REST, stature_m=1.8))
    assert len({listening.recvfrom(4000)[1] for _ in range(4)}) == 1


def test_time_is_since_the_output_opened_and_begins_anew_before_float32_is_too_coarse(
    sockets: ExitStack,
) -> None:
    port = free_port(socket.SOCK_DGRAM)
    listening = receiver(sockets, port)
    clock = Clock(NS_PER_S // 4)
    sink = running(sockets, to(port, bundle="one"), clock)
    sink.send(FRAME)
    sink.send(FRAME)
    assert [values(listening.recv(4000), "/VMC/Ext/T") for _ in range(2)] == [[0.25], [0.5]]
    clock.now_ns += round(T_PERIOD_S * NS_PER_S)
    sink.send(FRAME)
    assert values(listening.recv(4000), "/VMC/Ext/T") == [0.75]
    assert np.spacing(np.float32(T_PERIOD_S - 1.0)) < 1.0 / 100.0


def test_calibrated_is_said_as_soon_as_it_is_known(sockets: ExitStack) -> None:
    port = free_port(socket.SOCK_DGRAM)
    listening = receiver(sockets, port)
    sink = running(sockets, to(port, bundle="one"))
    told = []
    for cameras in (None, (CAMERA,), ()):
        if cameras is not None:
            sink.send_state(CalibrationInfo("pc", "rig.json", cameras))
        sink.send(FRAME)
        told.append(values(listening.recv(4000), "/VMC/Ext/OK"))
    assert told == [[1, 0, 0, 1], [1, 3, 0, 1], [1, 0, 0, 1]]


def test_each_person_has_a_port(sockets: ExitStack) -> None:
    port = free_port(socket.SOCK_DGRAM)
    first, third = receiver(sockets, port), receiver(sockets, port + 14)
    sink = running(sockets, to(port, bundle="one", port_step=7))
    moved = {
        **FRAME.joints,
        "hips": msgspec.structs.replace(FRAME.joints["hips"], p=(5.0, 1.0, 0.0)),
    }
    sink.send_state(msgspec.structs.replace(REST, person=2))
    for _ in range(2):
        sink.send(FRAME)
        sink.send(msgspec.structs.replace(FRAME, person=2, joints=moved))
    assert posed(Evmc4u(), [first.recv(4000)])["Hips"][0] == pytest.approx(0.35)
    assert posed(Evmc4u(), [third.recv(4000)])["Hips"][0] == pytest.approx(5.0)
    assert sink.status().sent == 4


def test_a_person_without_a_port_is_not_sent_and_does_no_harm(sockets: ExitStack) -> None:
    sink = running(sockets, to(65530))
    for person in (1, 15, 16, 10**9, -1):
        sink.send(msgspec.structs.replace(FRAME, person=person))
    assert sink.status().sent == 0


def test_frames_above_the_cap_are_not_sent(sockets: ExitStack) -> None:
    port = free_port(socket.SOCK_DGRAM)
    listening = receiver(sockets, port)
    sink = running(sockets, to(port, bundle="one", rate_hz=30.0), Clock(NS_PER_S // 120))
    for _ in range(120):
        sink.send(FRAME)
    assert 29 <= sink.status().sent <= 32
    assert listening.recv(4000)


def test_nobody_listening_is_a_state(sockets: ExitStack) -> None:
    port = free_port(socket.SOCK_DGRAM)
    sink = running(sockets, to(port))
    for _ in range(10):
        sink.send(FRAME)
    status = sink.status()
    assert status.listeners == 0
    assert status.detail == f"no receiver on 127.0.0.1:{port}"
    with receiver(sockets, port) as listening:
        sink.send(FRAME)
        assert listening.recv(2000).startswith(b"#bundle\0")


def test_closed_it_sends_nothing_and_opened_again_it_does(sockets: ExitStack) -> None:
    port = free_port(socket.SOCK_DGRAM)
    listening = receiver(sockets, port)
    sink = running(sockets, to(port, bundle="one"))
    sink.close()
    sink.close()
    sink.send(FRAME)
    assert sink.status().detail == "closed"
    sink.open()
    sink.send(FRAME)
    assert values(listening.recv(4000), "/VMC/Ext/OK") == [1, 0, 0, 1]


def test_an_address_without_a_route_is_unavailable() -> None:
    with pytest.raises(UnavailableError, match=r"vmc\.destinations.*255\.255\.255\.255"):
        VmcSink(Params(("255.255.255.255:39539",))).open()


def test_it_is_off_until_it_is_asked_for_and_every_setting_has_a_key() -> None:
    assert "vmc" not in [one.name for one in build_sinks(load({}), "pc")]
    flags = {
        "vmc.enabled": "true", "vmc.destinations": '["127.0.0.1:1234"]', "vmc.root": "root", "vmc.turn": "180",
        "vmc.yaw_deg": "-12.5", "vmc.mirror": "true", "vmc.bundle": "off", "vmc.rate_hz": "30", "vmc.port_step": "1",
    }  # fmt: skip
    assert load(flags)["vmc"] == VmcSection(
        ("127.0.0.1:1234",), 1, "root", 180, -12.5, True, "off", 30.0, "", enabled=True
    )
    assert "vmc" in [one.name for one in build_sinks(load(flags), "pc")]


@pytest.mark.parametrize(
    ("key", "text"),
    [
        ("destinations", '["localhost:39539"]'), ("root", "feet"), ("turn", "90"), ("bundle", "three"),
        ("rate_hz", "0"), ("rate_hz", "1000"), ("port_step", "0"), ("yaw_deg", "nan"), ("mirror", "maybe"),
    ],
)  # fmt: skip
def test_a_setting_that_does_not_do_is_named(key: str, text: str) -> None:
    with pytest.raises(ConfigError, match=rf"vmc\.{key}"):
        load({f"vmc.{key}": text})


def load(flags: dict[str, str]) -> Mapping[str, OutputSection]:
    return load_config(flags, env={}, candidates=()).config.outputs
