"""The record of one camera, as another thread reads it at any moment."""

from mocapd.capture.camera_thread.capture_record import CaptureRecord


def test_a_camera_is_not_silent_before_its_first_frame_is_counted() -> None:
    """Its thread may be interrupted between the two, as while it logs that the camera is back."""
    record = CaptureRecord("left")
    record.mark_live("")
    status = record.status(torn=0)
    assert not status.is_silent, status.trouble
