"""`mocapd cameras --at`: what a node has, with what to write into the configuration."""

import json

import pytest

from mocapd.capture.remote.remote_listing import list_remote
from mocapd.errors import ConfigError, UnavailableError
from tests.cli.mocapd_process import mocapd_here
from tests.node.node_pair import Pluggable, StreamingWebcam, opened, running_node
from tests.outputs.frames import free_port


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
