"""Addresses are shown without their secrets, whatever people write into them."""

import pytest

from mocapd.boundary.urls import (
    has_password,
    is_masked,
    split_url,
    without_password,
    without_passwords,
)
from mocapd.errors import ConfigError


@pytest.mark.parametrize(
    ("url", "shown"),
    [
        ("rtsp://10.0.0.7/stream", "rtsp://10.0.0.7/stream"),
        ("rtsp://admin@10.0.0.7/stream", "rtsp://admin@10.0.0.7/stream"),
        ("rtsp://admin:hunter2@10.0.0.7:554/s?x=1", "rtsp://admin:***@10.0.0.7:554/s?x=1"),
        ("rtsp://admin:hun/t#e?r2@10.0.0.7/s", "rtsp://admin:***@10.0.0.7/s"),
        ("rtsp://admin:a@b:c@10.0.0.7/s", "rtsp://admin:***@10.0.0.7/s"),
        ("RTSP://admin:hunter2@cam/s", "RTSP://admin:***@cam/s"),
        ("\nrtsp://admin:hunter2@cam/s", "\nrtsp://admin:***@cam/s"),
        (
            "http://cam/v.mjpg?user=admin&pwd=hunter2&x=1",
            "http://cam/v.mjpg?user=admin&pwd=***&x=1",
        ),
        ("http://cam/v?password=hunter2", "http://cam/v?password=***"),
        ("http://cam/v?access_token=hunter2#x", "http://cam/v?access_token=***#x"),
        ("http://cam:80/v?pwd=hun@ter2", "http://***"),
        ("/dev/video0", "/dev/video0"),
        ("usb:1-3:046d:0825:", "usb:1-3:046d:0825:"),
        ("clips/me@home:1.mp4", "clips/me@home:1.mp4"),
    ],
)
def test_a_password_is_never_shown(url: str, shown: str) -> None:
    assert without_password(url) == shown
    assert has_password(url) == (url != shown)


@pytest.mark.parametrize("url", ["rtsp://[bad", "rtsp://cam:port/x", "http://cam:99999/"])
def test_what_is_no_address_is_a_named_error(url: str) -> None:
    with pytest.raises(ConfigError, match="no address"):
        split_url(url)


def test_a_bad_address_is_told_without_its_password() -> None:
    for url in ("rtsp://admin:hunter2@[bad", "rtsp://admin:hunter2?x@cam:port/"):
        with pytest.raises(ConfigError) as told:
            split_url(url)
        assert "hunter2" not in str(told.value)


def test_a_masked_address_is_known_as_such() -> None:
    for url in ("rtsp://a:secret@host/x", "http://host/x?user=a&pwd=secret"):
        assert not is_masked(url)
        assert is_masked(without_password(url))
    assert not is_masked("usb:1-3:046d:0825:***")


def test_addresses_within_a_text_lose_their_passwords() -> None:
    text = "cam0: 'rtsp://u:p@ss@host/x' is lost, http://h/?pwd=s and v4l2 me@home"
    shown = without_passwords(text)
    assert shown == "cam0: 'rtsp://u:***@host/x' is lost, http://h/?pwd=*** and v4l2 me@home"
    assert without_passwords("rtsp://u:p w@host/x") == "rtsp://u:***@host/x"
