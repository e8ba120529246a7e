"""What the address of a camera at a node says, and that a wrong one is told without its password."""

import pytest

from mocapd.boundary.urls import without_password
from mocapd.capture.kinds.source_kinds import open_source
from mocapd.capture.remote.remote_address import RemoteAddress, parse_remote
from mocapd.errors import ConfigError


def test_whole_addresses() -> None:
    assert parse_remote("zenoh://pi.lan/attic/left") == RemoteAddress(
        "tcp/pi.lan:7447", "attic", "left"
    )
    assert parse_remote(
        "zenohs://pc:s%2Fcret@[fe80::1]:7448/attic/left?ca=/etc/ca.pem"
    ) == RemoteAddress("tls/[fe80::1]:7448", "attic", "left", "pc", "s/cret", "/etc/ca.pem")


@pytest.mark.parametrize(
    "address",
    [
        "zenoh://",
        "zenoh://host",
        "zenoh://host/attic",
        "zenoh://host/attic/left/more",
        "zenoh://host/attic/*",
        "zenoh://host/at%2Ftic/left",
        "zenoh://host:99999/attic/left",
        "zenoh://pc@host/attic/left",
        "zenoh://host/attic/left?ca=here.pem",
        "zenoh://host/attic/left?other=/x",
        "zenoh://host/attic/left?certificate=/only.pem",
        "zenoh://host/" + "x" * 65 + "/left",
        "zenoh://host/attic/left?" + "x" * 3000,
    ],
)
def test_a_wrong_one_is_told(address: str) -> None:
    with pytest.raises(ConfigError):
        open_source(address)


def test_its_password_is_shown_nowhere() -> None:
    address = "zenohs://pc:hunter2@host:7447/attic/left"
    assert "hunter2" not in without_password(address)
    assert "hunter2" not in repr(parse_remote(address))
    with pytest.raises(ConfigError) as caught:
        open_source("zenohs://pc:hunter2@host:7447/attic")
    assert "hunter2" not in str(caught.value)
    assert "hunter2" not in open_source(address).name
