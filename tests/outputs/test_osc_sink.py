"""The OSC sink against real UDP sockets: one that listens, one that does not."""

import socket

import pytest
from pythonosc.osc_bundle import OscBundle

from mocapd.errors import ConfigError, UnavailableError
from mocapd.outputs.osc.osc_sink import OscSink, Params
from mocapd.outputs.wire import SkeletonFrame
from tests.outputs.frames import free_port, small_frame, whole_frame


def receiver(port: int) -> socket.socket:
    listening = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    listening.bind(("127.0.0.1", port))
    listening.settimeout(5.0)
    return listening


def sink_to(*ports: int) -> OscSink:
    sink = OscSink(Params(tuple(f"127.0.0.1:{port}" for port in ports)))
    sink.open()
    return sink


def test_a_receiver_gets_every_part_of_the_frame() -> None:
    port = free_port(socket.SOCK_DGRAM)
    sink = sink_to(port)
    with receiver(port) as listening:
        for seq in range(3):
            sink.send(whole_frame(seq))
        for seq in range(3):
            for part in range(2):
                head = next(iter(OscBundle(listening.recv(2000))))
                assert head.params[1:4] == [seq, part, 2]
    status = sink.status()
    assert (status.sent, status.refused, status.listeners) == (3, 0, 1)
    assert status.detail == f"receiver on 127.0.0.1:{port}"
    sink.close()


@pytest.mark.parametrize("frame", [whole_frame(), small_frame(tracking="lost", joints={})])
def test_nobody_listening_is_a_state(frame: SkeletonFrame) -> None:
    port = free_port(socket.SOCK_DGRAM)
    sink = sink_to(port)
    for _ in range(10):
        sink.send(frame)
    status = sink.status()
    assert status.listeners == 0
    assert status.sent <= 1  # the answer to the last one is still to come
    assert status.sent + status.refused == 10
    assert status.detail == f"no receiver on 127.0.0.1:{port}"
    sink.close()


@pytest.mark.parametrize("frame", [whole_frame(), small_frame(tracking="lost", joints={})])
def test_the_first_frame_after_a_receiver_starts_arrives(frame: SkeletonFrame) -> None:
    port = free_port(socket.SOCK_DGRAM)
    sink = sink_to(port)
    for _ in range(3):
        sink.send(frame)
    with receiver(port) as listening:
        sink.send(frame)
        head = next(iter(OscBundle(listening.recv(2000))))
        assert head.params[2] == 0
        sink.send(frame)
        assert sink.status().listeners == 1
    for _ in range(3):
        sink.send(frame)
    assert sink.status().listeners == 0
    sink.close()


def test_each_destination_fares_by_itself() -> None:
    heard, unheard = free_port(socket.SOCK_DGRAM), free_port(socket.SOCK_DGRAM)
    sink = sink_to(unheard, heard)
    with receiver(heard) as listening:
        for _ in range(5):
            sink.send(small_frame())
        for _ in range(5):
            assert listening.recv(2000).startswith(b"#bundle\0")
    status = sink.status()
    assert status.listeners == 1
    assert status.sent >= 5
    assert f"no receiver on 127.0.0.1:{unheard}" in status.detail
    sink.close()


def test_more_shapes_than_are_kept_do_no_harm() -> None:
    port = free_port(socket.SOCK_DGRAM)
    sink = sink_to(port)
    with receiver(port) as listening:
        for i in range(100):
            sink.send(small_frame(tracker=f"tracker{i}"))
            assert f"tracker{i}".encode() in listening.recv(2000)
    sink.close()


def test_ipv6_works_and_closing_twice_too() -> None:
    try:
        listening = socket.create_server(("::1", 0), family=socket.AF_INET6)
    except OSError:
        pytest.skip("this machine has no IPv6 loopback")
    listening.close()
    sink = OscSink(Params(("[::1]:39541",)))
    sink.open()
    sink.send(small_frame())
    sink.close()
    sink.close()
    assert sink.status().detail == "closed"
    sink.send(small_frame())


@pytest.mark.parametrize(
    "text",
    ["localhost:39541", "127.0.0.1", "127.0.0.1:0", "127.0.0.1:70000", ":39541", "1.2.3:4", ""],
)
def test_destinations_that_do_not_do_say_what_does(text: str) -> None:
    with pytest.raises(ConfigError, match=r"osc\.destinations.*127\.0\.0\.1:39541"):
        Params((text,))


def test_an_address_without_a_route_is_unavailable() -> None:
    sink = OscSink(Params(("255.255.255.255:39541",)))  # broadcast is not permitted to us
    with pytest.raises(UnavailableError, match=r"255\.255\.255\.255:39541"):
        sink.open()
