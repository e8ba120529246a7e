"""VRChat found by OSCQuery on the loopback: it is followed where it starts anew, and strangers are not."""

import json
import sys
from collections.abc import Iterator
from ipaddress import IPv4Address
from typing import TYPE_CHECKING

import pytest

from mocapd.clock import NS_PER_S
from mocapd.errors import MissingExtraError
from mocapd.outputs.messages import Facing
from mocapd.outputs.output_table import VRChatSection, unsafe_outputs
from mocapd.outputs.vrchat import vrchat_finder
from mocapd.outputs.vrchat.vrchat_finder import VRChatFinder, is_of_local_network
from mocapd.outputs.vrchat.vrchat_sink import AUTO, Params, VRChatSink
from tests.outputs.frames import eventually
from tests.outputs.receivers.vrchat import VRChatReceiver
from tests.outputs.vrchat.fake_oscquery import LOOPBACK, FakeVRChat, host_info, vrchat
from tests.outputs.vrchat.poses import stepping_left

if TYPE_CHECKING:
    from zeroconf import Zeroconf


@pytest.fixture
def network() -> Iterator["Zeroconf"]:
    """The loopback alone."""
    pytest.importorskip("zeroconf", reason="the extra mocapd[vrchat] is not installed")
    from zeroconf import Zeroconf

    with Zeroconf(interfaces=[LOOPBACK]) as one:
        yield one


@pytest.fixture
def finder(monkeypatch: pytest.MonkeyPatch) -> Iterator[VRChatFinder]:
    monkeypatch.setattr(vrchat_finder, "LOOK_AGAIN_S", 0.1)
    one = VRChatFinder([LOOPBACK])
    yield one
    one.stop()


@pytest.fixture
def sink(finder: VRChatFinder) -> Iterator[VRChatSink]:
    one = VRChatSink(Params(AUTO), finder)
    one.open()
    yield one
    one.close()


def test_frames_go_to_where_vrchat_is_and_follow_it(
    network: "Zeroconf", finder: VRChatFinder, sink: VRChatSink
) -> None:
    frames = iter(range(1, 1000))

    def heard_by(one: FakeVRChat) -> list[str]:
        assert eventually(lambda: finder.address == one.osc), finder.detail
        number = next(frames)
        sink.send(stepping_left(now_ns=number * NS_PER_S))
        return VRChatReceiver().take(one.listening.recv(2000), float(number))

    sink.send_state(Facing("pc", 0, 0.0, 0))  # waits until there is somebody to be told
    sink.send(stepping_left())
    assert (sink.status().refused, sink.status().listeners) == (1, 0)
    assert eventually(lambda: "looking for VRChat" in sink.status().detail)
    with vrchat(network, "VRChat-Client-AAAAAA") as first:
        assert "/tracking/trackers/head/rotation" in heard_by(first)
    assert eventually(lambda: finder.address is None)
    with vrchat(network, "VRChat-Client-BBBBBB", says_goodbye=False) as second:
        heard_by(second)
    # it has crashed, and comes back under another name and other ports
    with vrchat(network, "VRChat-Client-CCCCCC") as third:
        heard_by(third)
        # who is in the network too is not taken for it
        said = host_info("VRChat-Client-DDDDDD", 1)
        liar = json.dumps(json.loads(said) | {"OSC_PORT": 0}).encode()
        with (
            vrchat(network, "SlimeVR-Server-1"),
            vrchat(network, "VRChat-Client-DDDDDD", answer=liar),
        ):
            assert eventually(lambda: "OSC_PORT" in finder.detail)
            heard_by(third)
    assert sink.status().sent == 4


@pytest.mark.parametrize(
    ("address", "expected"),
    [
        *((one, True) for one in ("127.0.0.1", "192.168.1.7", "10.0.0.2", "169.254.3.4")),
        *((one, False) for one in ("8.8.8.8", "0.0.0.0", "224.0.0.251", "255.255.255.255")),
    ],
)
def test_only_machines_of_local_networks_are_asked(address: str, expected: bool) -> None:
    assert is_of_local_network(IPv4Address(address)) is expected


def test_without_the_library_it_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "zeroconf", None)
    sink = VRChatSink(Params(AUTO))
    with pytest.raises(
        MissingExtraError, match=r"vrchat\.destination.*mocapd\[vrchat\].*zeroconf, or"
    ):
        sink.open()
    sink.close()


def test_that_anybody_may_announce_a_vrchat_is_told() -> None:
    (line,) = unsafe_outputs({"vrchat": VRChatSection(AUTO, enabled=True)})
    assert "whoever announces" in line
    assert unsafe_outputs({"vrchat": VRChatSection(enabled=True)}) == []
