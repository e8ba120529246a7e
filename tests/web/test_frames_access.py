"""The frames' WebSocket is for pages of allowed sites that were given the key, and for nothing else."""

import json
import os
import socket
import stat
from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import httpx
import pytest
from websockets.exceptions import ConnectionClosedError, InvalidStatus
from websockets.sync.client import ClientConnection
from websockets.sync.client import connect as open_socket
from websockets.typing import Origin

from mocapd.clock import NS_PER_S
from mocapd.config.web_params import Params
from mocapd.errors import InputError
from mocapd.outputs import messages, wire
from mocapd.pipeline.slowness import Slowness
from mocapd.web.games.frames_access import FILE_NAME, FramesAccess
from mocapd.web.games.frames_link import MOST_GAMES, UNREAD
from mocapd.web.runtime_file import Place, running
from mocapd.web.server import WebServer
from tests.web.browser import PATIENCE_S, connect, get, origin_of, token_of, until_closed
from tests.web.tiny_host import TinyHost

SITE, OTHER = "https://game.example", "http://localhost:8000"
ELSEWHERE = ("/ws", "/pictures", "/live", "/recording")


@pytest.fixture
def place(tmp_path: Path) -> Place:
    return Place(tmp_path / "run", tmp_path, "pc")


@pytest.fixture
def server(host: TinyHost, place: Place) -> Iterator[WebServer]:
    """Allows two sites."""
    died: list[BaseException] = []
    with WebServer(host, Params(allow_origins=(SITE, OTHER)), died.append, place) as one:
        yield one
    assert died == []


def address_of(server: WebServer, place: Place) -> str:
    """What the page of SITE connects to, out of the link that the user gives it."""
    (page,) = running(place.folder)
    access = FramesAccess(page.status.origins, page.status.frames_key)
    first, second = access.links(urlsplit(page.url).netloc)
    site, _, address = first.partition("/#mocapd=")
    assert site == SITE
    assert second == f"{OTHER}/#mocapd={address}"
    assert urlsplit(address).netloc == f"127.0.0.1:{server.port}"
    return address


def opened(address: str, origin: str | None, headers: Mapping[str, str] | None = None) -> Any:
    return open_socket(
        address,
        origin=None if origin is None else Origin(origin),
        additional_headers=dict(headers or {}),
        proxy=None,
        open_timeout=PATIENCE_S,
    )


def refused(address: str, origin: str | None, headers: Mapping[str, str] | None = None) -> int:
    with pytest.raises(InvalidStatus) as caught, opened(address, origin, headers):
        pass
    return caught.value.response.status_code


@pytest.mark.parametrize("origin", [SITE, OTHER])
def test_an_allowed_site_with_the_key_gets_rest_and_frames_of_the_wire(
    server: WebServer, place: Place, origin: str
) -> None:
    with opened(address_of(server, place), origin) as link:
        told = [str(link.recv(PATIENCE_S)) for _ in range(3)]
    rest = messages.decode_rest_skeleton(told[0].encode(), wire.JSON_MIME)
    frames = [wire.decode(one.encode(), wire.JSON_MIME) for one in told[1:]]
    assert rest.stature_m == pytest.approx(1.75)
    assert set(frames[0].joints) == set(rest.names)
    assert [frame.seq for frame in frames] == [0, 1]
    assert frames[0].joints["leftHand"].p[1] > 1.0, "the canned person waves"


def test_a_site_hears_that_tracking_is_too_slow(
    host: TinyHost, server: WebServer, place: Place
) -> None:
    host.slowness = Slowness(0.95, 1.5, 30.0, 640.0)
    with opened(address_of(server, place), SITE) as link:
        found = [str(link.recv(PATIENCE_S)) for _ in range(3)]
    (health,) = [one for one in found if messages.HEALTH in one]
    told = messages.decode_health(health.encode(), wire.JSON_MIME)
    assert told.slowness.startswith("too slow: 95 %")
    assert (told.instance, told.pid, told.outputs) == ("", 0, ())


def test_a_site_is_told_no_name_of_this_machine_and_no_picture(
    server: WebServer, place: Place
) -> None:
    with opened(address_of(server, place), SITE) as link:
        for _ in range(3):
            message = link.recv(PATIENCE_S)
            assert isinstance(message, str)
            tree = json.loads(message)
            assert tree["instance"] == ""
            assert tree.get("cameras", []) == []
            assert "cam0" not in message


@pytest.mark.parametrize(
    "origin",
    [
        "http://evil.example",  # another site
        None,  # no browser's page
        "null",  # a file, or a frame in a sandbox
        "http://game.example",  # without encryption
        "https://game.example:444",
        "https://game.example.evil.example",
        "https://GAME.example",
        "http://localhost:8001",  # another port of this machine
        "*",
        "",
    ],
)
def test_other_origins_are_refused_despite_the_key(
    server: WebServer, place: Place, origin: str | None
) -> None:
    assert refused(address_of(server, place), origin) == 403


def test_two_origins_are_refused(server: WebServer, place: Place) -> None:
    assert refused(address_of(server, place), SITE, {"origin": "http://evil.example"}) in (400, 403)


def test_a_foreign_host_is_refused_despite_origin_and_key(server: WebServer, place: Place) -> None:
    """As after DNS rebinding: a name of the attacker's leads to 127.0.0.1, with its own or a forged Origin."""
    address = address_of(server, place)
    rebound = address.replace("127.0.0.1", "rebound.example")
    for origin in (SITE, f"http://rebound.example:{server.port}"):
        reached = socket.create_connection(("127.0.0.1", server.port), PATIENCE_S)
        with reached, pytest.raises(InvalidStatus) as caught:
            open_socket(rebound, sock=reached, origin=Origin(origin), proxy=None)
        assert caught.value.response.status_code == 403


@pytest.mark.parametrize("key", ["", "wrong", "ü", "x" * 5000])
def test_an_allowed_site_without_the_key_is_refused(
    server: WebServer, place: Place, key: str
) -> None:
    address = address_of(server, place)
    assert refused(f"{address.partition('=')[0]}={key}", SITE) == 401
    assert refused(address.partition("?")[0], SITE) == 401


def test_the_pages_token_is_not_the_key(server: WebServer, place: Place) -> None:
    address = address_of(server, place)
    for token in (f"?key={token_of(server)}", f"?token={token_of(server)}"):
        assert refused(f"{address.partition('?')[0]}{token}", SITE) == 401
    assert (
        refused(f"{address.partition('?')[0]}?token={token_of(server)}", origin_of(server)) == 403
    )


def test_nor_is_it_below_the_pages_own_path(server: WebServer) -> None:
    page = httpx.get(server.url, trust_env=False, verify=False, timeout=PATIENCE_S)
    below = page.headers["location"].partition("?")[0]
    address = f"ws://127.0.0.1:{server.port}{below}frames?token={token_of(server)}"
    assert refused(address, origin_of(server)) == 403


@pytest.mark.parametrize("path", ELSEWHERE)
def test_an_allowed_site_gets_nothing_else(server: WebServer, place: Place, path: str) -> None:
    """Not even with the page's own token, which it is never given."""
    key = address_of(server, place).partition("=")[2]
    with pytest.raises(InvalidStatus) as caught, connect(server, path, origin=SITE):
        pass
    assert caught.value.response.status_code == 403
    assert refused(f"ws://127.0.0.1:{server.port}{path}?key={key}", SITE) == 403
    assert refused(f"ws://127.0.0.1:{server.port}{path}?token={key}", origin_of(server)) == 401


def test_an_allowed_site_cannot_fetch(server: WebServer, place: Place) -> None:
    key = address_of(server, place).partition("=")[2]
    for path in ("/", "/status", "/frames", "/page/app.js", "/picture/none"):
        answer = get(server, path, {"origin": SITE}, token=token_of(server), key=key)
        assert answer.status_code == 403
        assert "access-control-allow-origin" not in answer.headers
        assert get(server, path, token=key, key=key).status_code == 401


def test_without_allowed_origins_nobody_is_let_in(host: TinyHost, place: Place) -> None:
    with WebServer(host, Params(), lambda error: None, place) as server:
        (page,) = running(place.folder)
        assert (page.status.origins, page.status.frames_key) == ((), "")
        for query in ("?key=", "", f"?token={token_of(server)}"):
            for origin in (SITE, None, "null", origin_of(server)):
                address = f"ws://127.0.0.1:{server.port}/frames{query}"
                assert refused(address, origin) == 403
    assert not (place.state_dir / FILE_NAME).exists()


def test_a_page_that_reads_slowly_gets_the_newest_and_no_backlog(
    server: WebServer, place: Place
) -> None:
    with opened(address_of(server, place), SITE) as link:
        link.recv(PATIENCE_S)  # the rest skeleton
        first = [json.loads(link.recv(PATIENCE_S)) for _ in range(UNREAD)]
        with pytest.raises(TimeoutError):
            link.recv(0.1)
        for frame in first:
            link.send(json.dumps({"seen": frame["seq"]}))
        after = json.loads(link.recv(PATIENCE_S))
        assert after["seq"] == UNREAD
        assert after["capture_unix_ns"] - first[-1]["capture_unix_ns"] >= 0.1 * NS_PER_S


@pytest.mark.parametrize(
    "word",
    ["let me in", '{"seen": -1}', '{"seen": "all"}', '{"seen": 1' + " " * 200 + "}", b"\xff"],
)
def test_who_says_anything_else_is_shown_out(
    server: WebServer, place: Place, word: str | bytes
) -> None:
    with opened(address_of(server, place), SITE) as link:
        link.send(word)
        with pytest.raises(ConnectionClosedError):
            until_closed(link)


def test_games_take_no_room_of_the_page(server: WebServer, place: Place) -> None:
    address = address_of(server, place)
    with ExitStack() as games:
        sockets: list[ClientConnection] = [
            games.enter_context(opened(address, SITE)) for _ in range(MOST_GAMES)
        ]
        assert refused(address, SITE) == 503
        with connect(server, "/live") as page:
            page.recv(PATIENCE_S)
        sockets[0].recv(PATIENCE_S)


def test_the_key_is_kept_and_private(host: TinyHost, server: WebServer, place: Place) -> None:
    key = address_of(server, place).partition("=")[2]
    path = place.state_dir / FILE_NAME
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    server.stop()
    with WebServer(host, Params(allow_origins=(SITE,)), lambda error: None, place):
        (page,) = running(place.folder)
        assert page.status.frames_key == key


@pytest.mark.parametrize("content", [b"", b"short", b"\xff" * 32, b"x" * 5000])
def test_a_file_without_a_key_is_a_named_error(
    host: TinyHost, place: Place, content: bytes
) -> None:
    (place.state_dir / FILE_NAME).write_bytes(content)
    server = WebServer(host, Params(allow_origins=(SITE,)), lambda error: None, place)
    with pytest.raises(InputError, match=FILE_NAME):
        server.start()


def test_a_pipe_for_the_key_is_not_waited_for(host: TinyHost, place: Place) -> None:
    os.mkfifo(place.state_dir / FILE_NAME)
    server = WebServer(host, Params(allow_origins=(SITE,)), lambda error: None, place)
    with pytest.raises(InputError, match="no regular file"):
        server.start()
