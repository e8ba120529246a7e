"""The controls of a camera at its node, as a ControlDevice: each question goes over the network."""

from collections.abc import Callable
from dataclasses import asdict

from mocapd.capture.remote import camera_wire
from mocapd.capture.remote.camera_wire import Done, Order
from mocapd.capture.webcam.camera_controls import Control
from mocapd.capture.webcam.controls import Controls
from mocapd.capture.webcam.v4l2_ioctl import ControlRange
from mocapd.errors import UnavailableError

Ask = Callable[[Order], Done]
"""Hands an order to the node; raises UnavailableError when there is no answer."""


class RemoteControls:
    """See ControlDevice."""

    def __init__(self, camera: str, ask: Ask) -> None:
        self._camera, self._ask = camera, ask

    def range(self, control: Control) -> ControlRange | None:
        limits = self._done(Order("range", control)).limits
        return ControlRange(*limits) if limits is not None else None

    def read(self, control: Control) -> int | None:
        return self._done(Order("read", control)).value

    def write(self, control: Control, value: int) -> int | None:
        return self._done(Order("write", control, value)).value

    def keep(self, controls: Controls) -> None:
        """The node sets these now and whenever the camera comes back. Raises UnavailableError."""
        self._done(Order("keep", kept=camera_wire.LockedControls(**asdict(controls))))

    def _done(self, order: Order) -> Done:
        done = self._ask(order)
        if done.trouble:
            raise UnavailableError(done.trouble, self._camera, "look at the camera's node")
        return done
