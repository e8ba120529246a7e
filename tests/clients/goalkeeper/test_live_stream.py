"""The live stream's bad moments: no daemon, garbage, another version, silence; each is said, none ends the game."""

import time
from collections.abc import Iterator

import msgspec
import pytest

from goalkeeper.streams.live_stream import LiveStream
from goalkeeper.streams.sighting import Sighting
from mocapd.client import Link
from mocapd.clock import monotonic_ns
from mocapd.outputs import wire
from mocapd.outputs.messages import Health
from tests.clients.goalkeeper.session import session_frames
from tests.outputs.frames import eventually, free_port
from tests.outputs.zenoh_pair import Running, running_sink

FRAME = session_frames(0.1)[0]
HEALTH = Health("pc", "1", 1, 0, 1, "auto", "live", 30.0, 21.0, 30.5, 100, 2)


@pytest.fixture
def running() -> Iterator[Running]:
    """A daemon's output."""
    with running_sink() as one:
        yield one


@pytest.fixture
def stream(running: Running) -> Iterator[LiveStream]:
    """That listens to it."""
    live = LiveStream(Link(running.endpoint))
    running.heard()
    yield live
    live.close()


def _next(stream: LiveStream) -> Sighting:
    found: list[Sighting] = []

    def came() -> bool:
        found.extend(stream.poll(time.monotonic()))
        return bool(found)

    assert eventually(came)
    return found[0]


def _seen_now() -> wire.SkeletonFrame:
    return msgspec.structs.replace(FRAME, capture_monotonic_ns=monotonic_ns())


def test_without_a_daemon_it_says_what_to_start() -> None:
    live = LiveStream(Link(f"tcp/127.0.0.1:{free_port()}"))
    assert live.poll(0.0) == []
    assert "looking for mocapd" in live.state().trouble
    assert eventually(lambda: "start `mocapd run`" in live.state().trouble, 30.0)
    assert not live.state().ended
    live.close()


def test_an_address_that_is_none_is_said() -> None:
    live = LiveStream(Link("192.168.1.4:7447", typed_options=True))
    assert eventually(
        lambda: "--endpoint: '192.168.1.4:7447' is no Zenoh" in live.state().trouble, 30.0
    )
    live.close()


def test_a_frame_is_as_old_as_its_exposure(running: Running, stream: LiveStream) -> None:
    frame = _seen_now()
    running.sink.send(frame)
    one = _next(stream)
    late = one.captured_s != pytest.approx(frame.capture_monotonic_ns * 1e-9)
    # a frame that this machine let lie for a second is taken for one of another clock
    assert not late or time.monotonic() - frame.capture_monotonic_ns * 1e-9 > 1.0
    assert one.pose is not None
    assert one.pose.point("leftHand") == pytest.approx(FRAME.joints["leftHand"].p)
    assert stream.state().trouble == ""


def test_a_predicted_pose_is_of_the_time_that_it_is_for(
    running: Running, stream: LiveStream
) -> None:
    running.sink.send(msgspec.structs.replace(FRAME, capture_monotonic_ns=10_090_000_000))
    found: list[Sighting] = []

    def came() -> bool:
        found.extend(stream.poll(10.0))
        return bool(found)

    assert eventually(came)
    assert found[0].captured_s == pytest.approx(10.09)


def test_clocks_that_disagree_give_the_usual_age(running: Running, stream: LiveStream) -> None:
    running.sink.send(FRAME)  # of another boot, years ago
    one = _next(stream)
    assert one.captured_s == pytest.approx(time.monotonic() - 0.05, abs=5.0)


def test_silence_before_the_first_frame_is_no_stream_that_has_stopped(
    running: Running, stream: LiveStream
) -> None:
    """The daemon's outputs are open while it still compiles."""
    assert eventually(lambda: "waiting for its first frame" in stream.state().trouble)
    stream.poll(time.monotonic() + 5.0)
    assert "waiting for its first frame" in stream.state().trouble
    running.sink.send(_seen_now())
    _next(stream)
    assert stream.state().trouble == ""


def test_a_stream_that_stops_is_said(running: Running, stream: LiveStream) -> None:
    running.sink.send(_seen_now())
    _next(stream)
    now_s = time.monotonic()
    stream.poll(now_s + 5.0)
    assert "the stream has stopped" in stream.state().trouble


def test_a_daemon_that_is_too_slow_is_said(running: Running, stream: LiveStream) -> None:
    running.sink.send_state(
        msgspec.structs.replace(HEALTH, slowness="too slow: 95 % -- close other programs")
    )
    running.sink.send(_seen_now())
    _next(stream)

    def said() -> bool:
        stream.poll(time.monotonic())
        return stream.state().slow.startswith("too slow")

    assert eventually(said)
    running.sink.send_state(HEALTH)
    assert eventually(lambda: not said())


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"joints": {"hips": "here"}}, "is no mocapd.Skeleton.v1"),
        ({"schema": "mocapd.Skeleton.v2"}, "speaks 'mocapd.Skeleton.v2'"),
    ],
)
def test_what_is_not_understood_is_said_and_the_next_frame_is_taken(
    running: Running, stream: LiveStream, changes: dict[str, object], said: str
) -> None:
    running.sink.send(msgspec.structs.replace(FRAME, **changes))

    def heard() -> bool:
        return stream.poll(time.monotonic()) == [] and said in stream.state().trouble

    assert eventually(heard)
    running.sink.send(_seen_now())
    assert _next(stream).pose is not None
    assert stream.state().trouble == ""
