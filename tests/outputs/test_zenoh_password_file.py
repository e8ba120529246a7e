"""Which password files are refused, and that what is accepted lets exactly its users in."""

import os
from pathlib import Path

import pytest
import zenoh

from mocapd.errors import ConfigError
from mocapd.outputs.zenoh.zenoh_config import Params
from mocapd.outputs.zenoh.zenoh_password_file import MAX_BYTES
from mocapd.outputs.zenoh.zenoh_sink import ZenohSink
from tests.outputs.frames import free_port
from tests.outputs.zenoh_pair import other_program, running_sink

BOM = b"\xef\xbb\xbf"


@pytest.mark.parametrize(
    ("content", "what"),
    [
        (b"", "names no user"),
        (b"\n", "names no user"),
        (b"  \n\t\n", "names no user"),
        (BOM + b"game:hunter2\n", "byte order mark"),
        (b"game:hunter2\nhunter2\n", "line 2 of .* has no colon"),
        (b":hunter2\n", "line 1 of .* has no user"),
        (b"game:\n", "line 1 of .* has no password"),
        (b"game: \nother:hunter2\n", "line 1 of .* has no password"),
        (b"game:hunter2\ngame:hunter2\n", "lines 1 and 2 of .* same user"),
        (b"game:hunter2\rother:hunter2\r", "line 1 of .* control character"),
        (b"game:hunter2\n\xe4:hunter2\n", "line 2 of .* no UTF-8"),
        (b"game:hunter2" * MAX_BYTES, "more than 32768 bytes"),
    ],
)
def test_a_file_that_would_not_protect_is_refused_by_name(
    content: bytes, what: str, tmp_path: Path
) -> None:
    file = tmp_path / "users"
    file.write_bytes(content)
    with pytest.raises(ConfigError, match=what) as caught:
        Params(password_file=str(file))
    assert caught.value.where == "zenoh.password_file"
    assert "hunter2" not in str(caught.value)


def test_what_is_no_file_is_refused(tmp_path: Path) -> None:
    fifo = tmp_path / "fifo"
    os.mkfifo(fifo)
    for path in (fifo, tmp_path, tmp_path / "none", Path("/dev/zero"), tmp_path / ("x" * 300)):
        with pytest.raises(ConfigError, match="a file that exists"):
            Params(password_file=str(path))


def test_a_file_emptied_meanwhile_opens_nothing(tmp_path: Path) -> None:
    file = tmp_path / "users"
    file.write_text("game:secret\n")
    sink = ZenohSink(Params(port=free_port(), password_file=str(file)))
    file.write_text("")
    with pytest.raises(ConfigError, match="names no user"):
        sink.open()


@pytest.mark.parametrize(
    ("content", "user", "password"),
    [
        ("game:secret", "game", "secret"),
        ("\n  \ngame:secret\r\n\nother:one\r\n", "game", "secret"),
        ("game:se:cr:et\n", "game", "se:cr:et"),
        (" game : secret \n", "game", "secret"),
        ("#gäme:sé cret\n", "#gäme", "sé cret"),
    ],
)
def test_an_accepted_file_lets_its_users_in_and_nobody_else(
    content: str, user: str, password: str, tmp_path: Path
) -> None:
    file = tmp_path / "users"
    file.write_bytes(content.encode())
    with running_sink(password_file=str(file)) as running:
        with _log_in(running.endpoint, {"user": user, "password": password}):
            pass
        for wrong in ({}, {"user": user, "password": "wrong"}):
            with pytest.raises(zenoh.ZError):
                _log_in(running.endpoint, wrong)


def _log_in(endpoint: str, login: dict[str, str]) -> zenoh.Session:
    return other_program(
        endpoint,
        connect={"endpoints": [endpoint], "timeout_ms": 0},
        transport={"auth": {"usrpwd": login}},
    )
