"""The Zenoh sink and another program, over real sessions on this machine."""

import faulthandler
import os
import socket
import subprocess
import sys
import time

import msgspec
import psutil
import pytest
import zenoh

from mocapd.errors import UnavailableError
from mocapd.outputs import wire
from mocapd.outputs.messages import CalibrationInfo, CameraStatus, Facing, Health, RestSkeleton
from mocapd.outputs.zenoh.zenoh_config import Params
from mocapd.outputs.zenoh.zenoh_sink import ZenohSink
from tests.outputs.frames import eventually, free_port, small_frame, whole_frame
from tests.outputs.zenoh_pair import GET_S, Running, ask, other_program, running_sink

HEALTH = Health(
    instance="pc",
    version="0",
    pid=1,
    started_unix_ns=1,
    now_unix_ns=2,
    tracker="colour",
    tracking="live",
    rate_hz=30.0,
    latency_median_ms=20.0,
    latency_p95_ms=30.0,
    frame_sets=100,
    dropped=0,
)
CAMERA = CameraStatus(
    instance="pc",
    camera="left eye/usb",
    state="live",
    detail="",
    source="/dev/video0",
    identity="1-2 046d:0825",
    size_px=(640, 480),
    rate_hz=30.0,
    frames=100,
    lost_frames=0,
    reopened=0,
)

REST = RestSkeleton("pc", 0, 1.75, ("hips", "spine"), (-1, 0), ((0.0, 1.0, 0.0), (0.0, 0.125, 0.0)))


def own_sockets() -> set[tuple[str, str, int]]:
    """(kind, address, port) of every socket of this process that others could reach."""
    return {
        ("udp" if c.type == socket.SOCK_DGRAM else "tcp", c.laddr.ip, c.laddr.port)
        for c in psutil.Process().net_connections("inet")
        if c.status in (psutil.CONN_LISTEN, psutil.CONN_NONE)
    }


@pytest.mark.parametrize("message_format", ["msgpack", "json"])
def test_another_program_receives_the_frame(message_format: str) -> None:
    with (
        running_sink(format=message_format) as running,
        other_program(running.endpoint) as session,
        session.declare_subscriber("mocapd/**") as subscriber,
    ):
        running.heard()
        running.sink.send(whole_frame(seq=1))
        running.sink.send(small_frame(seq=2, person=1))
        first, second = subscriber.recv(), subscriber.recv()
        assert str(first.key_expr) == "mocapd/v1/pc/skeleton/0"
        assert str(first.encoding) == f"application/{message_format};mocapd.Skeleton.v1"
        assert wire.decode(first.payload.to_bytes(), str(first.encoding)) == whole_frame(seq=1)
        assert str(second.key_expr) == "mocapd/v1/pc/skeleton/1"
        assert (first.priority, first.express) == (zenoh.Priority.REAL_TIME, True)
        assert first.congestion_control == zenoh.CongestionControl.DROP


def test_exactly_one_socket_is_opened_and_it_is_on_the_loopback() -> None:
    before = own_sockets()
    with running_sink() as running:
        assert own_sockets() - before == {("tcp", "127.0.0.1", running.port)}
    assert eventually(lambda: own_sockets() == before)


def test_nothing_is_encoded_while_nobody_subscribes() -> None:
    with running_sink() as running:
        running.sink.send(small_frame())
        status = running.sink.status()
        assert (status.sent, status.refused, status.listeners) == (0, 1, 0)
        assert status.detail == f"nobody listens on {running.endpoint}"
        with other_program(running.endpoint) as session, session.declare_subscriber("mocapd/**"):
            running.heard()
            running.sink.send(small_frame())
        assert eventually(lambda: running.sink.status().listeners == 0)
        time.sleep(0.15)  # somebody who was just there is sent to for a tenth of a second
        running.sink.send(small_frame())
        assert (running.sink.status().sent, running.sink.status().refused) == (1, 2)


def test_status_says_who_listens() -> None:
    program = (
        "import sys, zenoh, json\n"
        "config = {'mode': 'client', 'connect': {'endpoints': [sys.argv[1]]},"
        " 'scouting': {'multicast': {'enabled': False}}}\n"
        "with zenoh.open(zenoh.Config.from_json5(json.dumps(config))) as session:\n"
        "    one = session.declare_subscriber('mocapd/v1/pc/skeleton/0')\n"
        "    two = session.declare_subscriber('mocapd/v1/*/skeleton/*')\n"
        "    sys.stdin.read()\n"
    )
    with running_sink() as running:
        game = subprocess.Popen(
            [sys.executable, "-c", program, running.endpoint], stdin=subprocess.PIPE
        )
        with game:
            running.heard()
            status = running.sink.status()
            assert status.listeners == 1
            assert f"(pid {game.pid})" in status.detail
            game.communicate()
        assert eventually(lambda: running.sink.status().listeners == 0)


def test_a_program_that_takes_no_frames_is_no_listener() -> None:
    with running_sink() as running, other_program(running.endpoint) as session:
        session.declare_subscriber("mocapd/v1/pc/health")
        assert ask(session, "mocapd/v1/pc/schema/**")  # by now the other is known, too
        assert running.sink.status().listeners == 0


def test_status_can_be_asked_while_programs_come_and_go() -> None:
    """The session's admin space, which says who subscribes, stopped the session for good (see `ListenerNames`)."""
    program = (
        "import sys, zenoh, json\n"
        "config = {'mode': 'client', 'connect': {'endpoints': [sys.argv[1]]},"
        " 'scouting': {'multicast': {'enabled': False}}}\n"
        "with zenoh.open(zenoh.Config.from_json5(json.dumps(config))) as session:\n"
        "    for n in range(40000):\n"
        "        session.declare_subscriber(f'mocapd/v1/pc/skeleton/{n % 50}').undeclare()\n"
    )
    faulthandler.dump_traceback_later(60.0, exit=True)  # nothing else ends what Zenoh holds
    with running_sink() as running:
        game = subprocess.Popen([sys.executable, "-c", program, running.endpoint])
        while game.poll() is None:
            running.sink.status()
        assert game.returncode == 0
        assert eventually(lambda: running.sink.status().listeners == 0)
    faulthandler.cancel_dump_traceback_later()


def state_of(running: Running) -> CalibrationInfo:
    calibration = CalibrationInfo("pc", "rig.json", ())
    for message in (HEALTH, CAMERA, calibration, REST, Facing("pc", 0, -30.0, 1)):
        running.sink.send_state(message)
    return calibration


def test_a_late_joiner_asks_for_the_state() -> None:
    with running_sink() as running:
        state_of(running)
        with other_program(running.endpoint) as session:
            encoding, health = ask(session, "mocapd/v1/pc/health")["mocapd/v1/pc/health"]
            assert encoding == "application/msgpack;mocapd.Health.v1"
            assert health["rate_hz"] == 30.0  # type: ignore[index]
            cameras = ask(session, "mocapd/v1/*/camera/*/status")
            assert list(cameras) == ["mocapd/v1/pc/camera/left_eye_usb/status"]
            calibration = ask(session, "mocapd/v1/pc/calibration")
            assert next(iter(calibration.values()))[1]["source"] == "rig.json"  # type: ignore[index]
            ((encoding, rest),) = ask(session, "mocapd/v1/*/rest_skeleton/0").values()
            assert encoding == "application/msgpack;mocapd.Skeleton.Rest.v1"
            assert rest["offsets_m"] == [[0.0, 1.0, 0.0], [0.0, 0.125, 0.0]]  # type: ignore[index]
            ((encoding, facing),) = ask(session, "mocapd/v1/*/facing/*").values()
            assert encoding == "application/msgpack;mocapd.Facing.v1"
            assert facing["yaw_deg"] == -30.0  # type: ignore[index]


def test_every_answer_comes_once_and_on_its_own_key() -> None:
    with running_sink() as running:
        state_of(running)
        with other_program(running.endpoint) as session:
            keys = [str(r.ok.key_expr) for r in session.get("mocapd/**") if r.ok is not None]
    assert sorted(keys) == [
        "mocapd/v1/pc/calibration",
        "mocapd/v1/pc/camera/left_eye_usb/status",
        "mocapd/v1/pc/facing/0",
        "mocapd/v1/pc/health",
        "mocapd/v1/pc/rest_skeleton/0",
        "mocapd/v1/pc/schema/mocapd.Calibration.v1",
        "mocapd/v1/pc/schema/mocapd.CameraStatus.v1",
        "mocapd/v1/pc/schema/mocapd.Facing.v1",
        "mocapd/v1/pc/schema/mocapd.Health.v1",
        "mocapd/v1/pc/schema/mocapd.Skeleton.Rest.v1",
        "mocapd/v1/pc/schema/mocapd.Skeleton.v1",
    ]


def test_the_schema_is_served() -> None:
    with running_sink() as running, other_program(running.endpoint) as session:
        ((encoding, schema),) = ask(session, "mocapd/v1/pc/schema/mocapd.Skeleton.v1").values()
    assert encoding == "application/schema+json"
    assert "SkeletonFrame" in schema["$defs"]  # type: ignore[index]


def test_changes_of_state_are_published_and_the_newest_is_kept() -> None:
    with running_sink(format="json") as running, other_program(running.endpoint) as session:
        with session.declare_subscriber("mocapd/v1/pc/camera/*/status") as subscriber:
            heard: list[zenoh.Sample] = []

            def is_told() -> bool:  # as soon as the daemon knows of the subscription
                running.sink.send_state(CAMERA)
                heard.extend(iter(subscriber.try_recv, None))
                return bool(heard)

            assert eventually(is_told)
            assert b'"state":"live"' in heard[0].payload.to_bytes()
        running.sink.send_state(msgspec.structs.replace(CAMERA, state="lost"))
        ((encoding, status),) = ask(session, "mocapd/v1/pc/camera/*/status").values()
    assert encoding == "application/json;mocapd.CameraStatus.v1"
    assert status["state"] == "lost"  # type: ignore[index]


def test_the_token_shows_that_the_daemon_lives_and_that_it_left() -> None:
    with running_sink() as running, other_program(running.endpoint) as session:
        seen = session.liveliness().declare_subscriber("mocapd/v1/*/alive", history=True)
        arrival = seen.recv()
        assert str(arrival.key_expr) == "mocapd/v1/pc/alive"
        assert arrival.kind == zenoh.SampleKind.PUT
        running.sink.close()
        assert seen.recv().kind == zenoh.SampleKind.DELETE


def test_whoever_connects_may_read_but_not_write() -> None:
    with (
        running_sink() as running,
        other_program(running.endpoint) as intruder,
        other_program(running.endpoint) as game,
        game.declare_subscriber("mocapd/**") as subscriber,
    ):
        running.heard()
        intruder.put("mocapd/v1/pc/skeleton/0", wire.encode_msgpack(small_frame(seq=666)))
        # and of the insides of sessions it sees its own only
        insides = [str(r.ok.key_expr) for r in intruder.get("@/**", timeout=GET_S) if r.ok]
        assert all(key.startswith(f"@/{intruder.zid()}/") for key in insides)
        running.sink.send(small_frame(seq=1))
        assert wire.decode(subscriber.recv().payload.to_bytes()).seq == 1
        assert subscriber.try_recv() is None


def test_a_taken_port_names_its_holder_and_the_ways_out() -> None:
    with socket.create_server(("127.0.0.1", 0)) as holder:
        port = holder.getsockname()[1]
        sink = ZenohSink(Params(port=port))
        with pytest.raises(UnavailableError) as caught:
            sink.open()
    text = str(caught.value)
    assert f"port {port} is taken by" in text
    assert f"(pid {os.getpid()})" in text
    assert "end it" in text
    assert f'zenoh.connect = ["tcp/127.0.0.1:{port}"]' in text
    assert "another zenoh.port" in text
    assert "\n" not in text
    assert ".rs" not in text
    sink.close()
    sink.open()  # the port is free again
    sink.close()


def test_a_taken_port_of_an_endpoint_with_options_is_named_with_the_key_that_has_it() -> None:
    with socket.create_server(("127.0.0.1", 0)) as holder:
        port = holder.getsockname()[1]
        sink = ZenohSink(Params(listen=(f"tcp/127.0.0.1:{port}#iface=lo",)))
        with pytest.raises(UnavailableError) as caught:
            sink.open()
    assert f"port {port} is taken by" in str(caught.value)
    assert "choose another port in zenoh.listen" in str(caught.value)


def test_it_joins_a_router_and_opens_no_socket_of_its_own() -> None:
    port = free_port()
    router = zenoh.Config()
    router.insert_json5("mode", '"router"')
    router.insert_json5("listen/endpoints", f'["tcp/127.0.0.1:{port}"]')
    router.insert_json5("scouting/multicast/enabled", "false")
    with zenoh.open(router):
        before = own_sockets()
        sink = ZenohSink(Params(connect=(f"tcp/127.0.0.1:{port}",)), "pc")
        sink.open()
        assert own_sockets() == before
        with other_program(f"tcp/127.0.0.1:{port}") as game:
            with game.declare_subscriber("mocapd/v1/pc/skeleton/0") as subscriber:
                assert eventually(lambda: sink.status().listeners == -1)
                sink.send(small_frame(seq=5))
                assert wire.decode(subscriber.recv().payload.to_bytes()).seq == 5
            sink.send_state(HEALTH)
            assert ask(game, "mocapd/v1/pc/health")
        assert eventually(lambda: sink.status().listeners == 0)
        assert "nobody listens" in sink.status().detail
        sink.close()


def test_a_router_that_is_not_there_is_unavailable() -> None:
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    sink = ZenohSink(Params(connect=(endpoint,), connect_timeout_s=0.2))
    with pytest.raises(UnavailableError, match=f"{endpoint}: no Zenoh router answers"):
        sink.open()


def test_closed_it_takes_frames_and_state_quietly() -> None:
    sink = ZenohSink(Params(port=free_port()))
    sink.send(small_frame())
    sink.send_state(HEALTH)
    assert sink.status().detail == "closed"
    sink.close()
    sink.close()


def test_a_process_that_forgets_to_close_still_ends() -> None:
    program = (
        "from mocapd.outputs.zenoh.zenoh_sink import ZenohSink\n"
        "from mocapd.outputs.zenoh.zenoh_config import Params\n"
        f"sink = ZenohSink(Params(port={free_port()}))\n"
        "sink.open()\n"
        "raise SystemExit(3)\n"
    )
    ended = subprocess.run([sys.executable, "-c", program], timeout=20, check=False)
    assert ended.returncode == 3
