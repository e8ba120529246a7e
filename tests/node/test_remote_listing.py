"""`mocapd cameras --at`: what a node has, with what to write into the configuration."""

import json
import resource
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import zenoh

from mocapd.bus.zenoh_answers import MOST_ANSWERS, limited_answers
from mocapd.capture.kinds.source_kinds import open_source
from mocapd.capture.remote import camera_wire
from mocapd.capture.remote.camera_wire import CameraState
from mocapd.capture.remote.remote_listing import list_remote
from mocapd.capture.source_request import SourceRequest
from mocapd.errors import ConfigError, UnavailableError
from tests.cli.mocapd_process import COMMAND, mocapd_here
from tests.node.node_pair import Pluggable, StreamingWebcam, opened, running_node
from tests.outputs.frames import eventually, free_port
from tests.outputs.zenoh_pair import other_program, running_router


def test_every_camera_with_its_source(clean_env: dict[str, str]) -> None:
    gone = Pluggable("gone")
    gone.plugged = False
    with running_node(StreamingWebcam("left"), gone) as running:
        opened(running.source("left")).close()
        place = f"zenoh://127.0.0.1:{running.port}"
        left_gone = [one.spec for one in list_remote(place)]
        assert left_gone == [f"{place}/attic/gone", f"{place}/attic/left"]
        assert [one.spec for one in list_remote(f"{place}/attic/left")] == [f"{place}/attic/left"]
        said = mocapd_here(clean_env, "cameras", "--at", f"{place}/attic")
        assert said.code == 0
        assert f"source  {place}/attic/left" in said.out
        assert "attic/left  64x48" in said.out
        assert "gone: is not plugged in" in said.out
        told = mocapd_here(clean_env, "cameras", "--json", "--at", place).out.splitlines()
        assert [json.loads(line)["camera"] for line in told] == ["gone", "left"]


def test_the_password_is_not_printed_and_nobody_is_told() -> None:
    with pytest.raises(UnavailableError) as caught:
        list_remote(f"zenoh://pc:hunter2@127.0.0.1:{free_port()}/attic")
    assert "hunter2" not in str(caught.value)
    with pytest.raises(ConfigError):
        list_remote("rtsp://host/attic")


def test_a_password_need_not_stand_on_the_command_line(
    clean_env: dict[str, str], tmp_path: Path
) -> None:
    users = tmp_path / "users"
    users.write_text("pc:sec/ret\n")
    users.chmod(0o600)
    with running_node(Pluggable("left"), password_file=str(users)) as running:
        place = f"127.0.0.1:{running.port}/attic"
        for password, code in (("sec/ret\n", 0), ("guess\n", 69)):
            done = subprocess.run(
                [*COMMAND, "cameras", "--at", f"zenoh://pc@{place}"],
                env=clean_env,
                input=password,
                capture_output=True,
                text=True,
                check=False,
            )
            assert done.returncode == code, done.stderr
            assert "sec" not in done.stdout + done.stderr
        told = mocapd_here(clean_env, "cameras", "--at", f"zenoh://pc:sec%2Fret@{place}")
    assert told.code == 0
    assert "the password stands on the command line" in told.err


@pytest.fixture
def router() -> Iterator[str]:
    with running_router() as endpoint:
        yield endpoint


@contextmanager
def answering(router: str, node: str, data: bytes) -> Iterator[None]:
    """Some program that answers as camera cam0 of a node would."""
    key = camera_wire.state(node, "cam0")
    with (
        other_program(router) as session,
        session.declare_queryable(key, lambda query: query.reply(key, data)),
    ):
        yield


def state(node: str, reason: str = "", run: int = 1) -> bytes:
    return camera_wire.encode(CameraState(node, "cam0", "lost", reason, (0, 0), 0.0, False, run))


def test_what_a_node_says_of_itself_gives_the_terminal_no_orders(
    router: str, clean_env: dict[str, str]
) -> None:
    place = f"zenoh://{router.removeprefix('tcp/')}"
    with answering(router, "odd", state("odd", "gone\x1b]0;owned\x07\nsource  zenoh://trap")):
        assert eventually(lambda: len(listed(place)) == 1)
        said = mocapd_here(clean_env, "cameras", "--at", place)
        assert "cannot be used: gone ]0;owned  source  zenoh://trap\n" in said.out
        with pytest.raises(UnavailableError) as caught:
            open_source(f"{place}/odd/cam0", SourceRequest("left")).open()
    assert str(caught.value).isprintable()


def test_two_nodes_of_one_name_are_told_apart_by_nobody_and_named(router: str) -> None:
    """As two small computers that are both called `raspberrypi`."""
    place = f"zenoh://{router.removeprefix('tcp/')}"
    with (
        answering(router, "attic", state("attic")),
        answering(router, "attic", state("attic", run=2)),
    ):
        assert eventually(lambda: len(listed(place)) == 2)
        with pytest.raises(UnavailableError, match=r"2 camera nodes are called 'attic'.*--name"):
            open_source(f"{place}/attic/cam0", SourceRequest("left")).open()


@pytest.mark.parametrize("strange", [b"\xff", state("a/b?ca=/trap"), state("")])
def test_one_that_is_not_understood_does_not_hide_the_others(router: str, strange: bytes) -> None:
    place = f"zenoh://{router.removeprefix('tcp/')}"
    with answering(router, "odd", strange):
        with answering(router, "attic", state("attic")):
            assert eventually(lambda: listed(place) == [f"{place}/attic/cam0"])
        with pytest.raises(UnavailableError, match="not understood"):
            list_remote(f"{place}/odd")


def test_answers_are_measured_before_they_are_kept(router: str) -> None:
    """200 of 7 MiB took 736 MB."""
    place = f"zenoh://{router.removeprefix('tcp/')}"
    key = camera_wire.state("big", "cam0")
    large = bytes(7 << 20)

    def answers(query: zenoh.Query) -> None:
        with query:
            for _ in range(60):
                query.reply(key, large)

    with (
        other_program(router) as session,
        session.declare_queryable(key, zenoh.handlers.Callback(answers, indirect=False)),
        answering(router, "attic", state("attic")),
    ):
        assert eventually(lambda: listed(place) == [f"{place}/attic/cam0"])
        before_kb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        with pytest.raises(UnavailableError, match="no camera node"):
            list_remote(f"{place}/big")
        assert eventually(lambda: listed(place) == [f"{place}/attic/cam0"])
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before_kb < 200_000


def test_of_many_answers_a_thousand_are_kept(router: str) -> None:
    key = camera_wire.state("many", "cam0")

    def answers(query: zenoh.Query) -> None:
        with query:
            for _ in range(MOST_ANSWERS + 200):
                query.reply(key, b"x")

    with (
        other_program(router) as session,
        session.declare_queryable(key, zenoh.handlers.Callback(answers, indirect=False)),
        other_program(router) as other,
    ):
        found = limited_answers(other, key, 10.0, 10, consolidation=zenoh.ConsolidationMode.NONE)
        assert len(found) == MOST_ANSWERS


def listed(place: str) -> list[str]:
    try:
        return [one.spec for one in list_remote(place)]
    except UnavailableError:
        return []
