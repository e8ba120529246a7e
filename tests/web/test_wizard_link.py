"""The setup over its WebSocket: views out, commands in, one window leads."""

import base64
import json
from collections.abc import Iterator

import httpx
import pytest

from mocapd.web.links.wizard_link import NOT_THE_DRIVER
from mocapd.web.server import WebServer
from tests.web.browser import PATIENCE_S, Window, get, origin_of, token_of
from tests.web.tiny_host import TinyHost


@pytest.fixture
def window(host: TinyHost, server: WebServer) -> Iterator[Window]:
    """The first window of a setup that is going on."""
    host.setup()
    one = Window(server)
    yield one
    one.close()


def test_the_page_is_told_what_to_show(window: Window) -> None:
    shown = window.wait(lambda view: view.get("setup", False))
    assert shown["step"] == "cameras"
    assert shown["steps"] == ["cameras"]  # those that this setup has
    assert shown["done"] == []
    assert shown["driver"] is True
    assert shown["cameras"] == ["cam0", "cam1"]
    assert shown["view"]["state"] == "waiting"
    assert shown["view"]["progress"] == 0.4
    assert shown["view"]["problems"] == [
        {"what": "too dark", "where": "cam1", "fix": "switch on a lamp"}
    ]


def test_commands_reach_the_step_and_the_change_comes_back(window: Window) -> None:
    window.do("rename", camera="cam0", name="left")
    shown = window.wait(lambda view: bool(view) and view["view"]["details"]["lengths"] != [])
    assert shown["view"]["sentence"] == "Told 1 times."
    assert shown["refused"] is None


def test_a_picture_of_strokes_fits_into_a_command(window: Window) -> None:
    png = base64.b64encode(bytes(5_000_000)).decode()
    window.do("strokes", png=png)
    shown = window.wait(lambda view: bool(view) and view["view"]["details"]["lengths"] != [])
    assert shown["view"]["details"]["lengths"][0] > 6_000_000


def test_what_the_step_refuses_is_told(window: Window) -> None:
    window.do("bad")
    shown = window.wait(lambda view: bool(view) and view["refused"] is not None)
    assert shown["refused"]["what"] == "strokes for 3 of 10 colours"
    window.do("good")
    window.wait(lambda view: view["refused"] is None)


@pytest.mark.parametrize("text", ["", "no JSON", "[]", '{"verb": 1}', '{"verb": "x", "args": 3}'])
def test_nonsense_is_refused_and_the_link_goes_on(window: Window, text: str) -> None:
    window.socket.send(text)
    shown = window.wait(lambda view: bool(view) and view["refused"] is not None)
    assert "not understood" in shown["refused"]["what"]
    window.do("good")
    window.wait(lambda view: view["refused"] is None)


def test_nothing_is_sent_while_nothing_changes(window: Window) -> None:
    window.wait(bool)
    with pytest.raises(TimeoutError):
        window.socket.recv(0.5)  # several ticks of the wizard


def test_a_second_window_looks_on_until_it_takes_over(server: WebServer, window: Window) -> None:
    window.wait(bool)
    second = Window(server)
    assert second.wait(bool)["driver"] is False
    second.do("rename")
    assert second.wait(lambda view: view["refused"] is not None)["refused"] == {
        "what": NOT_THE_DRIVER.what,
        "where": NOT_THE_DRIVER.where,
        "fix": NOT_THE_DRIVER.fix,
    }
    second.do("take_over")
    second.wait(lambda view: view["driver"])
    window.wait(lambda view: not view["driver"])
    second.do("rename")
    assert second.wait(lambda view: view["view"]["sentence"] == "Told 1 times.")["refused"] is None
    second.close()


def test_when_the_leading_window_closes_the_other_leads(server: WebServer, window: Window) -> None:
    window.wait(bool)
    second = Window(server)
    second.wait(bool)
    window.close()
    second.wait(lambda view: view["driver"])
    second.close()


def test_without_a_setup_the_page_may_begin_one(host: TinyHost, server: WebServer) -> None:
    one, other = Window(server), Window(server)
    assert one.wait(bool)["setup"] is False
    other.wait(bool)
    other.do("begin")
    assert other.wait(lambda view: view["setup"])["driver"] is True
    assert one.wait(lambda view: view["setup"])["driver"] is False
    assert host.begun == 1
    one.close()
    other.close()


def test_why_no_setup_can_begin_is_told(host: TinyHost, server: WebServer) -> None:
    host.why_not = "the cameras are being opened"
    one = Window(server)
    one.do("begin")
    shown = one.wait(lambda view: bool(view) and view["refused"] is not None)
    assert shown["refused"]["what"] == "the cameras are being opened"
    one.close()


def test_pictures_of_a_step_by_key(host: TinyHost, server: WebServer) -> None:
    host.setup()
    token = token_of(server)
    found = get(server, "/picture/strokes/1", token=token)
    assert found.headers["content-type"] == "image/png"
    assert found.content.startswith(b"\x89PNG")
    assert get(server, "/picture/strokes/0", token=token).status_code == 404


def test_another_process_may_begin_a_setup(host: TinyHost, server: WebServer) -> None:
    def post(body: str) -> httpx.Response:
        url = f"{origin_of(server)}/setup?token={token_of(server)}"
        return httpx.post(url, content=body, timeout=PATIENCE_S, trust_env=False)

    assert post("nonsense").status_code == 400
    host.why_not = "no camera"
    refused = post("{}")
    assert refused.status_code == 503
    assert json.loads(refused.text)["what"] == "no camera"
    host.why_not = ""
    assert post('{"step": "cameras"}').status_code == 200
    assert host.wizard is not None
    status = get(server, "/status", token=token_of(server)).json()
    assert status["setup"] == "cameras"
    assert status["cameras"] == ["cam0", "cam1"]
