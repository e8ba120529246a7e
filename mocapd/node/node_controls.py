"""Executes orders of the paired daemon for a webcam's controls, one after the other, within their ranges."""

import queue
import threading
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import replace

import msgspec
import zenoh

from mocapd.capture.remote import camera_wire
from mocapd.capture.remote.camera_wire import Done, LockedControls, Order
from mocapd.capture.webcam.camera_controls import ControlDevice
from mocapd.capture.webcam.control_lock import Lockable, as_held, restore
from mocapd.errors import MalformedError, UnavailableError

_MOST_WAITING = 16  # orders; a wizard waits for each answer


class ControlOrders:
    """Takes orders from `attach` until its `opened` is closed. `node_access` decides the permission."""

    def __init__(self, source: Lockable) -> None:
        self._source, self._own = source, source.settings
        self._orders: queue.Queue[zenoh.Query | None] = queue.Queue(_MOST_WAITING)
        self._lock = threading.Lock()  # held while the camera is set

    def attach(
        self,
        session: zenoh.Session,
        key: str,
        opened: ExitStack,
        died: Callable[[BaseException], None],
    ) -> None:
        """Answers orders on this key."""

        def work() -> None:
            try:
                while (query := self._orders.get()) is not None:
                    done = self.done(query.payload.to_bytes() if query.payload else b"")
                    with query:
                        query.reply(key, camera_wire.encode(done), encoding=camera_wire.ENCODING)
            except zenoh.ZError:
                return  # the session was closed while the camera was set
            except BaseException as error:  # reported to the owner
                died(error)
                raise

        # a driver may block, Zenoh's own thread must not
        thread = threading.Thread(target=work, name="orders", daemon=True)
        thread.start()
        opened.callback(self._end, thread)
        handler = zenoh.handlers.Callback(self._take, indirect=False)
        opened.enter_context(session.declare_queryable(key, handler))

    def done(self, data: bytes) -> Done:
        """Executes an encoded order; the result reports any trouble."""
        try:
            order = camera_wire.decode(data, Order)
        except MalformedError as error:
            return Done(trouble=f"not understood: {error.what}")
        try:
            with self._lock:
                return self._done(order)
        except UnavailableError as error:
            return Done(trouble=error.what)

    def _done(self, order: Order) -> Done:
        if order.verb == "keep":
            return self._keep(order.kept)
        device = self._source.device()
        if device is None:
            return Done(trouble="is not open at the moment")
        if order.control is None:
            return Done(trouble="no control is named")
        limits = device.range(order.control)
        if order.verb == "range":
            return Done(limits=(limits.low, limits.high, limits.step) if limits else None)
        if limits is None:
            return Done()
        if order.verb == "read":
            return Done(value=device.read(order.control))
        return self._write(device, order, limits.low, limits.high)

    def _write(self, device: ControlDevice, order: Order, low: int, high: int) -> Done:
        assert order.control is not None
        if not low <= order.value <= high:
            return Done(trouble=f"{order.control} takes {low} to {high}, not {order.value}")
        return Done(value=device.write(order.control, order.value))

    def _keep(self, locked: LockedControls) -> Done:
        """Sets controls now and at each opening; missing ones have the node's configured value."""
        given = msgspec.structs.asdict(locked).items()
        own = self._own.controls
        controls = replace(own, **{name: value for name, value in given if value is not None})
        settings = self._source.settings
        if controls != settings.controls:
            self._source.change(replace(settings, controls=controls))
            device = self._source.device()
            if device is not None:
                restore(device, as_held(controls))
        return Done()

    def _take(self, query: zenoh.Query) -> None:
        try:
            self._orders.put_nowait(query)
        except queue.Full:
            with query:
                pass  # unanswered

    def _end(self, thread: threading.Thread) -> None:
        try:
            self._orders.put_nowait(None)
        except queue.Full:
            return
        thread.join(0.2)
