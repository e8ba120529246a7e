"""Several daemons behind one router: each is found, and what it says, and that it is gone."""

import json
from collections.abc import Iterator
from contextlib import ExitStack

import msgspec
import pytest

from mocapd.app.terminal.watch_all import as_dict, as_text, watch_all
from mocapd.client import Link
from mocapd.outputs.messages import CameraStatus, Health
from mocapd.outputs.zenoh import keys
from mocapd.outputs.zenoh.zenoh_config import Params
from mocapd.outputs.zenoh.zenoh_instances import Instances, InstanceState, list_instances
from mocapd.outputs.zenoh.zenoh_sink import ZenohSink
from tests.cli.mocapd_process import mocapd_here
from tests.outputs.frames import eventually
from tests.outputs.zenoh_pair import other_program, running_router


def health(instance: str) -> Health:
    return Health(instance, "0.1.0", 1, 0, 1, "auto", "live", 30.0, 21.0, 30.5, 100, 2)


def camera(instance: str, name: str, state: str = "live", detail: str = "") -> CameraStatus:
    return CameraStatus(
        instance, name, state, detail, "usb:1", "", (640, 480), 30.0, 9, 0, 0, "steady"
    )


@pytest.fixture
def router() -> Iterator[str]:
    with running_router() as endpoint:
        yield endpoint


def daemon(router: str, name: str, opened: ExitStack) -> ZenohSink:
    sink = ZenohSink(Params(connect=(router,)), name)
    opened.callback(sink.close)
    sink.open()
    sink.send_state(health(name))
    sink.send_state(camera(name, "left"))
    sink.send_state(camera(name, "right", "lost", "was unplugged"))
    return sink


def by_name(instances: Instances) -> dict[str, InstanceState]:
    return {one.name: one for one in instances.states()}


def test_all_are_listed_and_one_that_ends_is_gone(router: str) -> None:
    with ExitStack() as opened:
        sinks = [daemon(router, name, opened) for name in ("hall-2", "hall-1")]
        session = opened.enter_context(other_program(router))
        found: list[InstanceState] = []

        def listed() -> bool:
            found[:] = list_instances(session)
            return len(found) == 2 and all(len(one.cameras) == 2 for one in found)

        assert eventually(listed)
        assert [one.name for one in found] == ["hall-1", "hall-2"]
        assert found[0].health == health("hall-1")
        instances = Instances()
        instances.follow(session, opened)
        assert len(instances.states()) == 2
        sinks[0].close()
        assert eventually(lambda: not by_name(instances)["hall-2"].alive)
        assert by_name(instances)["hall-1"].alive
        assert "gone for" in as_text(by_name(instances)["hall-2"])
        assert [one.name for one in list_instances(session)] == ["hall-1"]
        late = daemon(router, "hall-3", opened)
        assert eventually(lambda: len(by_name(instances)) == 3)
        late.send_state(camera("hall-3", "right"))
        assert eventually(lambda: "2 of 2 cameras" in as_text(by_name(instances)["hall-3"]))


def test_a_line_says_what_is_wrong() -> None:
    cameras = {
        "left": camera("pc", "left"),
        "right": camera("pc", "right", "lost", "was unplugged"),
    }
    known = InstanceState("pc", True, health("pc"), cameras, heard_ns=0)
    line = as_text(known)
    for part in ("30.0 Hz", "auto live", "21 ms (p95 30)", "1 of 2 cameras", "silent for"):
        assert part in line
    assert "right lost: was unplugged" in line
    assert "effort" not in line
    slow = msgspec.structs.replace(health("pc"), effort="saving")
    assert "saving effort" in as_text(InstanceState("pc", True, slow, cameras))
    assert json.loads(json.dumps(as_dict(known)))["health"]["tracker"] == "auto"


def test_what_a_daemon_says_of_itself_gives_the_terminal_no_orders() -> None:
    odd = {"left": camera("pc", "left", "lost", "\x1b[2Jgone\nhall-9 30.0 Hz")}
    assert as_text(InstanceState("pc", True, health("pc"), odd)).isprintable()
    assert as_text(InstanceState("pc", trouble="\x1b[2J")).isprintable()


def test_what_is_not_understood_is_told_beside_the_others(router: str) -> None:
    with ExitStack() as opened:
        daemon(router, "hall-1", opened)
        stranger = opened.enter_context(other_program(router))
        session = opened.enter_context(other_program(router))
        instances = Instances()
        instances.follow(session, opened)

        def told() -> bool:
            stranger.put(
                keys.health("odd"), b"\xff", encoding="application/msgpack;mocapd.Health.v9"
            )
            return "odd" in by_name(instances)

        assert eventually(told)
        assert "mocapd.Health.v9" in as_text(by_name(instances)["odd"])
        assert by_name(instances)["hall-1"].trouble == ""


def test_status_of_all_says_the_worst_by_its_exit_code(
    router: str, clean_env: dict[str, str]
) -> None:
    words = ("status", "--all", "--endpoint", router)
    assert mocapd_here(clean_env, *words).code == 3
    with ExitStack() as opened:
        daemon(router, "hall-1", opened)
        one = mocapd_here(clean_env, *words)
        assert one.code == 0, one.err
        assert "1 of 2 cameras" in one.out
        sink = daemon(router, "hall-2", opened)
        for name in ("left", "right"):
            sink.send_state(camera("hall-2", name, "lost", "was unplugged"))
        both = mocapd_here(clean_env, *words, "--json")
        assert both.code == 150
        assert [json.loads(line)["instance"] for line in both.out.splitlines()] == [
            "hall-1",
            "hall-2",
        ]


def test_rounds_of_lines_are_printed(router: str, capsys: pytest.CaptureFixture[str]) -> None:
    with ExitStack() as opened:
        daemon(router, "hall-1", opened)
        watch_all(Link(router, connect_timeout_s=30.0), as_json=True, count=1)
    lines = capsys.readouterr().out.splitlines()
    assert [json.loads(line)["instance"] for line in lines] == ["hall-1"]
