"""Who is named for frames that do not arrive: this machine, the camera and its link, or the light."""

from dataclasses import replace
from typing import Any

import pytest

from mocapd.calibrate.verification.delivery import Delivery, Grade, delivery_judgements
from mocapd.capture.camera_link import CameraLink

ALL_ARRIVE = Delivery(received=150, lost=0, rate_hz=29.9, asked_hz=30.0, link=CameraLink.USB)
SLOW = ("too slow: 80 % of the frame sets are skipped", "close other programs")


def said(**changes: Any) -> str:
    """What is said of figures that are not good."""
    judged = delivery_judgements(replace(ALL_ARRIVE, **changes))
    return "; ".join(f"{what} -- {fix}" for grade, what, fix in judged if grade is not Grade.GOOD)


def test_nothing_is_said_of_a_camera_whose_frames_arrive() -> None:
    assert [said(link=link) for link in CameraLink] == [""] * len(CameraLink)


def test_a_webcam_that_loses_frames_before_they_reach_us_needs_another_usb_port() -> None:
    assert "another USB port" in said(lost=60)


@pytest.mark.parametrize("figures", [{"late": 60}, {"rate_hz": 12.0}])
def test_usb_is_not_blamed_for_frames_that_came(figures: dict[str, Any]) -> None:
    assert said(**figures)
    assert "USB" not in said(**figures)


@pytest.mark.parametrize("link", [one for one in CameraLink if one is not CameraLink.USB])
@pytest.mark.parametrize("figures", [{"lost": 60}, {"late": 60}, {"rate_hz": 12.0}])
def test_usb_is_never_blamed_for_what_is_not_on_usb(
    link: CameraLink, figures: dict[str, Any]
) -> None:
    assert said(link=link, **figures)
    assert "USB" not in said(link=link, **figures)


def test_a_simulated_camera_can_only_be_too_fast_for_this_machine() -> None:
    text = said(link=CameraLink.PLAYER, lost=60)
    assert "this machine is too slow" in text
    assert "close other programs" in text


@pytest.mark.parametrize("link", list(CameraLink))
@pytest.mark.parametrize("figures", [{"lost": 60}, {"late": 60}, {"rate_hz": 12.0}])
def test_a_machine_that_is_too_slow_is_named_for_every_camera(
    link: CameraLink, figures: dict[str, Any]
) -> None:
    (text,) = said(link=link, slow=SLOW, **figures).split("; ")
    what, fix = text.split(" -- ")
    assert "this machine is too slow" in what
    assert fix == "close other programs"
