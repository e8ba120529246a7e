"""A webcam that the setup closes to open it in another mode has not failed."""

import threading
from pathlib import Path

import pytest

from mocapd.capture.camera_thread.capture_status import CaptureState
from mocapd.capture.camera_thread.reopening import BackOff, RestartBudget
from mocapd.capture.camera_thread.thread import CaptureThread
from mocapd.capture.webcam.v4l2 import V4l2Source
from mocapd.clock import monotonic_ns
from mocapd.errors import CameraClosed, UnavailableError
from mocapd.types import Frame
from tests.capture.films import picture
from tests.capture.test_thread import Shelf, nobody_dies, wait_until


class ModalCamera:
    """A webcam whose mode can be changed."""

    name = "left"
    recorded = False

    def __init__(self) -> None:
        self._closed = threading.Event()
        self._seq = 0
        self.is_unplugged = False

    def open(self) -> None:
        if self.is_unplugged:
            raise UnavailableError("is not plugged in", self.name)
        self._closed.clear()

    def read(self) -> Frame:
        if self._closed.wait(0.005):
            raise CameraClosed("was closed", self.name)
        self._seq += 1
        return Frame(self.name, self._seq, monotonic_ns(), picture(self._seq % 256))

    def close(self) -> None:
        self._closed.set()


def test_many_changes_of_its_mode_do_not_quarantine_a_webcam() -> None:
    camera, shelf = ModalCamera(), Shelf()
    budget = RestartBudget(most=2, within_s=60.0, rest_s=300.0)
    capture = CaptureThread(camera, shelf, nobody_dies, back_off=BackOff(0.01), budget=budget)
    capture.start()
    for change in range(1, 6):
        assert shelf.wait_for(len(shelf.items) + 1)
        camera.close()
        assert wait_until(lambda change=change: capture.status().reopens == change)  # type: ignore[misc]
    assert capture.status().state is CaptureState.LIVE
    assert capture.stop()


class Told:
    """Keeps who went."""

    def __init__(self) -> None:
        self.gone: list[str] = []

    def went(self, camera: str, /) -> None:
        self.gone.append(camera)


def test_a_webcam_has_gone_only_if_it_does_not_open_again() -> None:
    """Two of one model that go together are doubted: nobody swaps them while their mode changes."""
    camera, shelf, told = ModalCamera(), Shelf(), Told()
    capture = CaptureThread(camera, shelf, nobody_dies, back_off=BackOff(0.01), presence=told)
    capture.start()
    assert shelf.wait_for(1)
    camera.close()
    assert wait_until(lambda: capture.status().reopens == 1)
    assert told.gone == []
    camera.is_unplugged = True
    camera.close()
    assert wait_until(lambda: told.gone == ["left"])
    camera.is_unplugged = False
    assert wait_until(lambda: capture.status().reopens == 2)
    assert capture.stop()
    assert told.gone == ["left"]


def test_a_webcam_says_that_it_was_closed() -> None:
    with pytest.raises(CameraClosed):
        V4l2Source("left", Path("/dev/null")).read()
