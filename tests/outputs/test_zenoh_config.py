"""Which Zenoh parameters are refused, and in which words."""

from pathlib import Path

import pytest
import zenoh

from mocapd.errors import ConfigError
from mocapd.outputs.instance import chunk
from mocapd.outputs.zenoh import keys
from mocapd.outputs.zenoh.zenoh_config import Params, is_loopback, listen_endpoints, session_config


def test_by_default_it_listens_on_the_loopback_only_and_scouts_nobody() -> None:
    config = session_config(Params())
    assert config["listen"] == {"endpoints": ["tcp/127.0.0.1:7447"]}
    assert config["scouting"] == {"multicast": {"enabled": False}, "gossip": {"enabled": False}}
    assert "connect" not in config


def test_joining_a_router_listens_nowhere() -> None:
    params = Params(connect=("tcp/127.0.0.1:7447",))
    assert listen_endpoints(params) == ()
    config = session_config(params)
    assert config["mode"] == "client"
    assert "listen" not in config


def test_tls_on_a_network(tmp_path: Path) -> None:
    pem = tmp_path / "some.pem"
    pem.write_text("")
    users = tmp_path / "users"
    users.write_text("game:secret\n")
    params = Params(
        listen=("tls/0.0.0.0:7447",),
        tls_certificate=str(pem),
        tls_private_key=str(pem),
        tls_root_ca=str(pem),
        tls_require_client=True,
        password_file=str(users),
    )
    tls = session_config(params)["transport"]["link"]["tls"]
    assert tls["enable_mtls"] is True
    assert session_config(params)["access_control"]["default_permission"] == "deny"


@pytest.mark.parametrize(
    ("wrong", "key", "mend"),
    [
        ({"format": "xml"}, "zenoh.format", "msgpack, json"),
        ({"port": 0}, "zenoh.port", "1 to 65535"),
        ({"port": 70000}, "zenoh.port", "1 to 65535"),
        ({"connect_timeout_s": 0.0}, "zenoh.connect_timeout_s", "more than 0"),
        ({"listen": ("tcp/0.0.0.0:7447",)}, "zenoh.listen", "tls/0.0.0.0:7447"),
        ({"listen": ("tcp/pc.lan:7447",)}, "zenoh.listen", "allow_unencrypted"),
        ({"listen": ("tls/0.0.0.0:7447",)}, "zenoh.listen", "zenoh.tls_certificate"),
        ({"listen": ("127.0.0.1:7447",)}, "zenoh.listen", "tcp/127.0.0.1:7447"),
        ({"listen": ("tcp/127.0.0.1",)}, "zenoh.listen", "protocol/address:port"),
        ({"connect": ("localhost",)}, "zenoh.connect", "protocol/address:port"),
        (
            {"listen": ("tcp/127.0.0.1:1",), "connect": ("tcp/127.0.0.1:2",)},
            "zenoh.connect",
            "not both",
        ),
        ({"tls_root_ca": "/no/such/file.pem"}, "zenoh.tls_root_ca", "a file that exists"),
        ({"password_file": "/no/such/file"}, "zenoh.password_file", "a file that exists"),
        ({"tls_require_client": True}, "zenoh.tls_require_client", "zenoh.tls_root_ca"),
    ],
)
def test_what_does_not_do_is_named_with_its_mend(
    wrong: dict[str, object], key: str, mend: str
) -> None:
    with pytest.raises(ConfigError) as caught:
        Params(**wrong)  # type: ignore[arg-type]
    assert caught.value.where == key
    assert mend in caught.value.fix


def test_plain_tcp_on_a_network_can_be_asked_for() -> None:
    params = Params(listen=("tcp/0.0.0.0:7447",), allow_unencrypted=True)
    assert listen_endpoints(params) == ("tcp/0.0.0.0:7447",)


@pytest.mark.parametrize(
    ("endpoint", "stays"),
    [
        ("tcp/127.0.0.1:7447", True),
        ("tcp/127.0.0.2:7447", True),
        ("tcp/[::1]:7447", True),
        ("tcp/0.0.0.0:7447", False),
        ("tcp/[::]:7447", False),
        ("tcp/192.168.1.4:7447", False),
        ("tcp/somewhere:7447", False),
        ("tcp/127.0.0.1:7447#iface=lo:1", True),
        ("tcp/[::1]:7447?prio=1:2", True),
        ("tcp/0.0.0.0:7447#iface=127.0.0.1:1", False),
        ("tcp/0.0.0.0:7447?x=/127.0.0.1:1", False),
    ],
)
def test_loopback_addresses_are_told_from_others(endpoint: str, stays: bool) -> None:
    assert is_loopback(endpoint) is stays


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("left", "left"),
        ("cam-1.left_2", "cam-1.left_2"),
        ("a/b*c$d?e#f@g h", "a_b_c_d_e_f_g_h"),
        ("größe", "gr__e"),
        ("", "_"),
    ],
)
def test_any_name_becomes_one_chunk_of_a_key(name: str, expected: str) -> None:
    assert chunk(name) == expected
    assert (
        str(zenoh.KeyExpr(keys.camera_status("pc", name)))
        == f"mocapd/v1/pc/camera/{expected}/status"
    )
