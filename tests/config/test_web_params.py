"""Which origins may be allowed: what a browser would send, and what nobody on the way could change."""

import pytest

from mocapd.config.effective import load_config
from mocapd.config.web_params import Params, is_of_this_machine
from mocapd.errors import ConfigError


@pytest.mark.parametrize(
    ("origin", "here"),
    [
        ("https://game.example", False),
        ("https://game.example:8443", False),
        ("https://192.168.0.4", False),
        ("http://localhost:8000", True),
        ("http://127.0.0.1:8000", True),
        ("http://[::1]:8000", True),
        ("https://localhost", True),
    ],
)
def test_origins_as_browsers_send_them(origin: str, here: bool) -> None:
    assert Params(allow_origins=(origin,)).allow_origins == (origin,)
    assert is_of_this_machine(origin) is here


@pytest.mark.parametrize(
    "origin",
    [
        *("*", "null", "", "https://*.example", "https://", "game.example", "//game.example"),
        *("https://game.example/", "https://game.example/play", "https://Game.example"),
        *("https://me@game.example", "https://game.example:443", "http://localhost:80"),
        *("https://game.example:0", "https://game.example:123456", "file://", "ws://localhost:1"),
        *("https://game.example\n", "https://gäme.example", "https://game..example"),
    ],
)
def test_what_no_browser_sends_is_refused(origin: str) -> None:
    with pytest.raises(ConfigError, match=r"https://game\.example or http://localhost:8000"):
        Params(allow_origins=(origin,))


@pytest.mark.parametrize("origin", ["http://game.example", "http://192.168.0.4:8000"])
def test_sites_without_encryption_are_refused(origin: str) -> None:
    with pytest.raises(ConfigError, match=f"write {origin.replace('http', 'https')}"):
        Params(allow_origins=(origin,))


def test_it_is_set_as_a_list_and_empty_by_default() -> None:
    assert load_config({}, None, env={}).config.web.allow_origins == ()
    flags = {"web.allow_origins": '["http://localhost:8000"]'}
    assert load_config(flags, None, env={}).config.web.allow_origins == ("http://localhost:8000",)
    with pytest.raises(ConfigError, match=r"web\.allow_origins"):
        load_config({"web.allow_origins": '["http://game.example"]'}, None, env={})
