"""Webcam identities: written, read, and found again in whichever socket."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocapd.capture.webcam.identity import WebcamIdentity, match_identity, parse_identity
from mocapd.errors import ConfigError, UnavailableError

LEFT = WebcamIdentity("1-3", "046d", "0825", "AA01")
RIGHT = WebcamIdentity("1-4.2", "046d", "0825", "BB02")
TWIN_A = WebcamIdentity("1-1", "1bcf", "28c4", "")
TWIN_B = WebcamIdentity("1-2", "1bcf", "28c4", "")


def at(identity: WebcamIdentity, port_path: str) -> WebcamIdentity:
    return WebcamIdentity(port_path, *identity.model)


hex4 = st.text("0123456789abcdef", min_size=4, max_size=4)
ports = st.lists(st.integers(1, 15), min_size=1, max_size=5).map(lambda p: ".".join(map(str, p)))
identities = st.builds(
    WebcamIdentity, ports.map(lambda path: f"1-{path}"), hex4, hex4, st.text(max_size=20)
)


@given(identities)
def test_an_identity_survives_being_written_into_a_config(identity: WebcamIdentity) -> None:
    assert parse_identity(str(identity)) == identity


def test_the_written_form_is_the_documented_one() -> None:
    assert str(LEFT) == "usb:1-3:046d:0825:AA01"
    assert parse_identity("usb:1-3:046D:0825") == WebcamIdentity("1-3", "046d", "0825", "")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("usb:", "not a webcam identity"),
        ("usb:1-3:046d", "not a webcam identity"),
        ("1-3:046d:0825:X", "not a webcam identity"),
        ("usb:video0:046d:0825:", "'video0' is not a USB port path"),
        ("usb:1-3.:046d:0825:", "is not a USB port path"),
        ("usb:1-3:46d:0825:", "'46d' is not a vendor id"),
        ("usb:1-3:046d:webcam:", "'webcam' is not a product id"),
    ],
)
def test_a_wrong_identity_says_which_part(text: str, said: str) -> None:
    with pytest.raises(ConfigError, match=said) as caught:
        parse_identity(text)
    assert "mocapd cameras" in caught.value.fix


def test_a_camera_in_its_own_socket_is_found() -> None:
    match = match_identity(LEFT, [RIGHT, LEFT])
    assert match.identity == LEFT
    assert not match.moved


def test_a_camera_in_another_socket_is_known_by_its_serial() -> None:
    match = match_identity(LEFT, [RIGHT, at(LEFT, "2-1")])
    assert match.identity == at(LEFT, "2-1")
    assert match.moved


def test_twins_are_told_apart_by_their_sockets() -> None:
    assert match_identity(TWIN_A, [TWIN_B, TWIN_A]).identity == TWIN_A
    assert match_identity(TWIN_B, [TWIN_B, TWIN_A]).identity == TWIN_B


def test_the_socket_of_an_unplugged_twin_is_not_filled_by_the_other() -> None:
    with pytest.raises(UnavailableError, match="not plugged in"):
        match_identity(TWIN_A, [TWIN_B], others=[TWIN_B])


def test_a_moved_twin_is_known_while_the_other_stays() -> None:
    match = match_identity(TWIN_A, [TWIN_B, at(TWIN_A, "1-7")], others=[TWIN_B])
    assert match.identity.port_path == "1-7"
    assert match.moved


def test_two_moved_twins_are_refused_rather_than_guessed() -> None:
    present = [at(TWIN_A, "1-7"), at(TWIN_B, "1-8")]
    with pytest.raises(UnavailableError, match=r"2 webcams.*1-7, 1-8"):
        match_identity(TWIN_A, present, others=[TWIN_B])


def test_where_two_twins_are_away_one_that_comes_back_elsewhere_is_not_guessed() -> None:
    present = [at(TWIN_A, "1-7")]
    for wanted, other in ((TWIN_A, TWIN_B), (TWIN_B, TWIN_A)):
        with pytest.raises(UnavailableError, match=r"may be this one or its twin.*1-1|1-2"):
            match_identity(wanted, present, others=[other])


def test_a_moved_webcam_of_its_own_serial_is_known_while_others_of_its_kind_are_away() -> None:
    match = match_identity(LEFT, [at(LEFT, "2-1")], others=[RIGHT])
    assert match.identity.port_path == "2-1"


def test_another_model_in_the_socket_is_not_taken() -> None:
    with pytest.raises(UnavailableError):
        match_identity(LEFT, [at(RIGHT, LEFT.port_path)])
