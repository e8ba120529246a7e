"""The client as a game uses it: newest wins, blocking and asyncio, restarts, clear errors."""

import asyncio
import math
import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from itertools import count
from pathlib import Path
from unittest.mock import MagicMock

import pytest
import zenoh

from mocapd import client, clock
from mocapd.errors import ConfigError, InputError, UnavailableError
from mocapd.outputs import wire
from mocapd.outputs.wire import SkeletonFrame
from mocapd.outputs.zenoh import daemon_link
from tests.outputs.frames import eventually, free_port, small_frame, whole_frame
from tests.outputs.prediction.moving import distance_m, frame_at, swinging, walking
from tests.outputs.zenoh_pair import running_sink

ROOT = Path(__file__).resolve().parents[2]


def test_the_newest_frame_wins() -> None:
    with running_sink() as running, client.Client(client.Link(running.endpoint)) as game:
        running.heard()
        assert game.poll() is None
        seqs: list[int] = []

        def frames_that_were_not_fetched_are_gone() -> bool:
            body = game.poll()
            seqs.extend([body.seq] if body is not None else [])
            return len(seqs) >= 5 and seqs[-1] - seqs[0] > len(seqs)

        with _sending(running.sink.send):
            assert eventually(frames_that_were_not_fetched_are_gone)
        assert seqs == sorted(set(seqs))
        last = 1_000_000
        running.sink.send(small_frame(seq=last))
        assert eventually(lambda: (body := game.poll()) is not None and body.seq == last)
        assert game.poll() is None
        assert game.wait(0.05) is None


def test_a_game_predicts_a_motion_that_goes_on() -> None:
    """Frames come one by one, as a game that draws at its own rate fetches them; then it asks for what is to come."""
    with running_sink() as running, client.Client(client.Link(running.endpoint)) as game:
        running.heard()
        assert game.predict(0.0) is None
        frames = [frame_at(k / 30.0, swinging, walking) for k in range(8)]
        for frame in frames:
            running.sink.send(frame)
            assert eventually(partial(_has_come, game, frame.seq))
        truth = frame_at(7 / 30.0 + 0.033, swinging, walking)
        ahead = game.predict(truth.capture_unix_ns / 1e9)
        assert ahead is not None
        held_m = distance_m(frames[-1], truth, "leftHand")
        assert distance_m(ahead.frame, truth, "leftHand") < 0.3 * held_m


def test_a_game_that_already_has_a_body_predicts_from_it() -> None:
    with running_sink() as running, client.Client(client.Link(running.endpoint)) as game:
        running.heard()
        running.sink.send(frame_at(0.0, swinging, walking))
        body = game.wait(30.0)
        assert body is not None
        assert game.predict(0.0) == body


def _has_come(game: client.Client, seq: int) -> bool:
    body = game.predict(0.0)
    return body is not None and body.seq == seq


def test_a_body_is_easy_to_read() -> None:
    frame = whole_frame()
    body = client.Body(frame)
    assert body.tracked
    assert "leftHand" in body
    assert "tail" not in body
    assert body["leftHand"].position_m == frame.joints["leftHand"].p
    assert body["leftHand"].rotation_xyzw == frame.joints["leftHand"].r
    assert body["leftHand"].local_rotation_xyzw == frame.joints["leftHand"].l
    assert body["leftHand"].confidence == frame.joints["leftHand"].c
    assert body["leftHand"].uncertainty_m == frame.joints["leftHand"].u
    assert body["leftFoot"].uncertainty_m == math.inf  # unknown: it weighs nothing
    assert list(body) == list(body.joints) == list(frame.joints)
    assert body.latency_s == pytest.approx(1 / 64)
    with pytest.raises(KeyError):
        body["tail"]


def test_age_counts_from_the_exposure() -> None:
    captured_ns = clock.monotonic_ns() - clock.nanoseconds(0.5)
    frame = small_frame(capture_unix_ns=captured_ns + clock.unix_from_monotonic_ns())
    assert 0.5 <= client.Body(frame).age_s < 5.0


def test_a_lost_body_is_not_tracked() -> None:
    body = client.Body(small_frame(tracking="lost", joints={}))
    assert not body.tracked
    assert body.tracking == "lost"
    assert list(body) == []


def test_stream_blocks_for_the_next_body_and_ends_the_connection_when_left() -> None:
    with running_sink() as running, _sending(running.sink.send):
        seen = []
        for body in client.stream(running.endpoint):
            seen.append(body.seq)
            if len(seen) == 5:
                break
        assert seen == sorted(set(seen))
        assert eventually(lambda: running.sink.status().listeners == 0)


@contextmanager
def _sending(send: Callable[[SkeletonFrame], None]) -> Iterator[None]:
    """A frame every five milliseconds, until the block is left."""
    enough = threading.Event()

    def send_on() -> None:
        for seq in count():
            send(small_frame(seq=seq))
            if enough.wait(0.005):
                return

    sender = threading.Thread(target=send_on)
    sender.start()
    try:
        yield
    finally:
        enough.set()
        sender.join()


def test_astream_gives_the_newest_body() -> None:
    async def play(endpoint: str) -> list[int]:
        seen = []
        async for body in client.astream(endpoint):
            seen.append(body.seq)
            await asyncio.sleep(0.05)  # slower than the daemon
            if len(seen) == 5:
                break
        return seen

    with running_sink() as running, _sending(running.sink.send):
        seen = asyncio.run(play(running.endpoint))
        assert seen == sorted(set(seen))
        assert seen[-1] - seen[0] > len(seen)  # it skipped what it was too slow for
        assert eventually(lambda: running.sink.status().listeners == 0)


def test_astream_can_be_cancelled_while_waiting() -> None:
    async def wait_in_vain(endpoint: str) -> None:
        async with asyncio.timeout(0.3):
            async for _ in client.astream(endpoint, connect_timeout_s=None):
                raise AssertionError("nobody sends")

    with running_sink() as running, pytest.raises(TimeoutError):
        asyncio.run(wait_in_vain(running.endpoint))
    with pytest.raises(TimeoutError):
        asyncio.run(wait_in_vain(f"tcp/127.0.0.1:{free_port()}"))


def test_a_connection_that_comes_after_its_cancellation_is_closed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Else a program that gives up and tries again keeps one open for each try."""
    begun, given_up = threading.Event(), threading.Event()
    session = MagicMock()

    def attempt(_: client.Link) -> MagicMock:
        begun.set()
        given_up.wait()
        return session

    async def give_up() -> None:
        connecting = asyncio.create_task(daemon_link.connect_async(client.Link()))
        await asyncio.to_thread(begun.wait)
        connecting.cancel()
        with pytest.raises(asyncio.CancelledError):
            await connecting
        given_up.set()
        while not session.__exit__.called:
            await asyncio.sleep(0.01)

    monkeypatch.setattr(daemon_link, "_attempt", attempt)
    asyncio.run(asyncio.wait_for(give_up(), 30.0))


def test_it_goes_on_when_the_daemon_comes_back() -> None:
    port = free_port()
    with running_sink(port) as running:
        game = client.Client(client.Link(running.endpoint))
        running.heard()
        running.sink.send(small_frame(seq=1))
        first = game.wait(30.0)
    assert first is not None
    with running_sink(port) as running:
        assert eventually(lambda: running.sink.status().listeners == 1)
        running.sink.send(small_frame(seq=2))
        second = game.wait(30.0)
    assert second is not None
    assert second.seq == 2
    game.close()
    game.close()


@pytest.mark.parametrize(
    "use",
    [
        lambda game: game.poll(),
        lambda game: game.wait(0.0),
        lambda game: game.predict(),
        lambda game: game.rest(),
        lambda game: game.health(),
        lambda game: next(iter(game)),
    ],
    ids=["poll", "wait", "predict", "rest", "health", "iter"],
)
def test_one_that_is_closed_says_so(use: Callable[[client.Client], object]) -> None:
    with running_sink() as running:
        game = client.Client(client.Link(running.endpoint))
        game.close()
        with pytest.raises(UnavailableError, match="this Client is closed"):
            use(game)


@pytest.mark.parametrize("timeout_s", [0.0, 0.3])
def test_nothing_there_is_one_clear_line(timeout_s: float) -> None:
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    with pytest.raises(
        UnavailableError, match=f"no mocapd at {endpoint} -- start `mocapd run` or pass endpoint="
    ):
        next(client.stream(endpoint, connect_timeout_s=timeout_s))


def test_options_are_named_as_they_are_typed() -> None:
    link = client.Link(f"tcp/127.0.0.1:{free_port()}", connect_timeout_s=0.0, typed_options=True)
    with pytest.raises(UnavailableError, match=r"start `mocapd run` or pass --endpoint$"):
        client.Client(link)


@pytest.mark.parametrize("endpoint", ["127.0.0.1:7447", "http://pc:7447", "pc", ""])
def test_what_is_no_endpoint_is_not_waited_for(endpoint: str) -> None:
    with pytest.raises(ConfigError, match=r"no Zenoh endpoint -- write .*tcp/127\.0\.0\.1:7447"):
        client.Client(client.Link(endpoint, connect_timeout_s=None))


def test_a_zenoh_router_without_mocapd_is_told_from_nothing() -> None:
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    router = zenoh.Config()
    router.insert_json5("mode", '"router"')
    router.insert_json5("listen/endpoints", f'["{endpoint}"]')
    router.insert_json5("scouting/multicast/enabled", "false")
    with zenoh.open(router), pytest.raises(UnavailableError, match="a Zenoh node answers"):
        client.Client(client.Link(endpoint, connect_timeout_s=0.0))


def test_another_instance_is_not_mistaken_for_ours() -> None:
    with running_sink() as running, pytest.raises(UnavailableError, match="mocapd/v1/attic/alive"):
        client.Client(client.Link(running.endpoint, instance="attic", connect_timeout_s=0.0))


def test_a_daemon_is_chosen_by_its_configured_name() -> None:
    link = client.Link(instance="Küche 1")
    assert link.key == "mocapd/v1/K_che_1/skeleton/0"
    assert link.rest_key == "mocapd/v1/K_che_1/rest_skeleton/0"
    assert client.Link().health_key == "mocapd/v1/*/health"
    with running_sink() as running, pytest.raises(UnavailableError, match="v1/p_c/alive"):
        client.Client(client.Link(running.endpoint, instance="p/c", connect_timeout_s=0.0))


def test_it_waits_for_a_daemon_that_starts_later() -> None:
    port = free_port()
    got: list[client.Body] = []

    def play() -> None:
        got.append(next(client.stream(f"tcp/127.0.0.1:{port}", connect_timeout_s=None)))

    game = threading.Thread(target=play)
    game.start()
    time.sleep(0.3)
    with running_sink(port) as running:
        running.heard()
        running.sink.send(small_frame())
        game.join(60.0)
    assert len(got) == 1


def test_a_frame_of_another_version_says_so() -> None:
    with running_sink() as running, client.Client(client.Link(running.endpoint)) as game:
        running.heard()
        running.sink.send(small_frame(schema="mocapd.Skeleton.v9"))
        with pytest.raises(InputError, match="same version of mocapd"):
            game.wait(30.0)


@pytest.mark.parametrize("seconds", [0.0, 0.05, 0.2, 0.5])
def test_a_game_that_leaves_without_closing_ends_well(seconds: float) -> None:
    """Wherever its thread is: one in five of those that were still connecting was aborted."""
    program = (
        "import sys, threading, time, mocapd.client\n"
        "def read():\n"
        "    for body in mocapd.client.stream(sys.argv[1]): pass\n"
        "threading.Thread(target=read, daemon=True).start()\n"
        f"time.sleep({seconds})\n"
    )
    with running_sink() as running:
        ended = subprocess.run(
            [sys.executable, "-c", program, running.endpoint], cwd=ROOT, timeout=60, check=False
        )
    assert ended.returncode == 0


def test_importing_the_client_is_light() -> None:
    program = (
        "import sys, mocapd.client\n"
        "heavy = {'cv2', 'numba', 'scipy', 'numpy', 'psutil', 'matplotlib'} & set(sys.modules)\n"
        "sys.exit(f'loads {heavy}' if heavy else 0)\n"
    )
    ended = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert ended.returncode == 0, ended.stderr


def test_the_sample_prints_the_left_hand() -> None:
    sample = ROOT / "clients" / "python" / "print_pose.py"
    with running_sink() as running:
        printing = subprocess.Popen(
            [sys.executable, str(sample), running.endpoint],
            stdout=subprocess.PIPE,
            env=os.environ | {"PYTHONPATH": str(ROOT), "PYTHONUNBUFFERED": "1"},
            text=True,
        )
        running.heard()
        running.sink.send(whole_frame(seq=1))
        assert printing.stdout is not None
        line = printing.stdout.readline()
        printing.terminate()
        printing.communicate(timeout=60)
    x, y, z = wire.decode(wire.encode_msgpack(whole_frame())).joints["leftHand"].p
    assert f"{x:+.2f} {y:+.2f} {z:+.2f}" in line
