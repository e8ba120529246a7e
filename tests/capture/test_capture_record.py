"""The record of one camera, as another thread reads it at any moment."""

import logging

import pytest

from mocapd.capture.camera_thread.capture_record import CaptureRecord


def test_a_camera_is_not_silent_before_its_first_frame_is_counted() -> None:
    """Its thread may be interrupted between the two, as while it logs that the camera is back."""
    record = CaptureRecord("left")
    record.mark_live("")
    status = record.status(torn=0)
    assert not status.is_silent, status.trouble


def test_a_notice_that_comes_and_goes_all_night_does_not_fill_the_log(
    caplog: pytest.LogCaptureFixture,
) -> None:
    """The noise of a dark room is black or not from one second to the next."""
    record = CaptureRecord("left")
    with caplog.at_level(logging.INFO):
        for _ in range(500):
            record.set_notice("its picture is black", "")
            record.set_notice("", "")
    assert [one.levelname for one in caplog.records] == ["WARNING", "INFO"] * 10
