"""The cameras' controls during a setup: its steps lock them, and the end of the setup restores them."""

import threading
from collections.abc import Iterable
from dataclasses import replace
from typing import Protocol, runtime_checkable

from mocapd.capture.base import Source
from mocapd.capture.webcam import control_lock
from mocapd.capture.webcam.camera_controls import Control, ControlDevice
from mocapd.capture.webcam.control_lock import Held, Lockable
from mocapd.capture.webcam.controls import Controls
from mocapd.capture.webcam.v4l2 import WebcamSettings
from mocapd.capture.webcam.v4l2_ioctl import ControlRange
from mocapd.errors import UnavailableError


@runtime_checkable
class MayRefuse(Protocol):
    """A Lockable source of another machine, which learns at its opening whether its camera accepts settings."""

    @property
    def takes_orders(self) -> bool: ...


class CameraLocks:
    """Which cameras can be locked, and the original values of their controls.

    Made by the owner of the sources, with a longer life than steps. The `finally` of the process must call `restore`, so
    that a SIGTERM restores too. Thread-safe; methods that access a camera raise UnavailableError when it is gone, or
    after `restore`.
    """

    def __init__(self, sources: Iterable[Source]) -> None:
        self._sources = {source.name: source for source in sources if isinstance(source, Lockable)}
        self._asked = {name: source.settings for name, source in self._sources.items()}
        self._lock = threading.RLock()  # guards the following, also during camera access
        self._before: dict[str, Held] = {}
        self._ended = False

    def can_lock(self, camera: str) -> bool:
        """Whether it is a webcam, here or at a node that takes orders of this daemon; simulated cameras, files and
        network cameras are not."""
        source = self._sources.get(camera)
        return source is not None and not (
            isinstance(source, MayRefuse) and not source.takes_orders
        )

    def set_free(self, camera: str) -> None:
        """Switch its automatics on; the first call stores the original values."""
        with self._lock:
            device = self._device(camera)
            if camera not in self._before:
                self._before[camera] = control_lock.read_held(device)
            control_lock.set_free(device, self._before[camera])

    def lock(self, camera: str, fps_hz: float, mains_hz: int | None) -> None:
        """Switch its automatics off, see `control_lock.lock`; `set_free` comes first."""
        with self._lock:
            control_lock.lock(self._device(camera), self._before[camera], fps_hz, mains_hz)

    def range(self, camera: str, control: Control) -> ControlRange | None:
        """The control's range; None when the camera does not have it."""
        with self._lock:
            return self._device(camera).range(control)

    def read(self, camera: str, control: Control) -> int | None:
        """The control's value; None when the camera does not have it."""
        with self._lock:
            return self._device(camera).read(control)

    def write(self, camera: str, control: Control, value: int) -> None:
        """Set one control of a locked camera."""
        with self._lock:
            self._device(camera).write(control, value)

    def keep(self, camera: str, mains_hz: int | None) -> Controls:
        """The locked values; every opening restores them from now on, also after a replug."""
        with self._lock:
            source = self._sources[camera]
            controls = control_lock.as_controls(
                self._device(camera), self._before[camera], mains_hz
            )
            source.change(replace(source.settings, controls=controls))
            return controls

    def change_mode(self, camera: str, size_px: tuple[int, int], fps_hz: float) -> None:
        """Reopen it with this size and rate."""
        with self._lock:
            source = self._sources[camera]
            source.change(replace(source.settings, size_px=size_px, fps_hz=fps_hz))

    def take_up(self, camera: str, settings: WebcamSettings) -> None:
        """Lock it to the result of an earlier setup: now, if open, and at each opening."""
        with self._lock:
            source = self._sources[camera]
            device = None if self._ended else source.device()
            if device is not None:
                if camera not in self._before:
                    self._before[camera] = control_lock.read_held(device)
                control_lock.restore(device, control_lock.as_held(settings.controls))
            source.change(settings)

    def restore(self) -> None:
        """Restore the original values; no locking afterwards. Idempotent."""
        with self._lock:
            self._ended = True
            for name, before in self._before.items():
                source = self._sources[name]
                asked = self._asked[name].controls
                source.change(replace(source.settings, controls=asked))
                device = source.device()
                if device is None:
                    continue  # unplugged: it loses its controls anyway
                try:
                    control_lock.restore(device, before)
                except UnavailableError:
                    continue
            self._before.clear()

    def _device(self, camera: str) -> ControlDevice:
        device = self._sources[camera].device()
        if self._ended:
            raise UnavailableError("the setup has ended", camera, "begin it again")
        if device is None:
            raise UnavailableError("is not open at the moment", camera, "wait until it is back")
        return device
