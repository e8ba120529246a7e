"""A slow sink on a thread of its own, behind a mailbox of the newest frame and the newest of each state."""

import threading
from dataclasses import replace

from mocapd.outputs.base import Sink, SinkStatus
from mocapd.outputs.messages import StateMessage, subject
from mocapd.outputs.sink_thread import SinkThread
from mocapd.outputs.wire import SkeletonFrame


class ThreadedSink:
    """Wraps any sink: `send` and `send_state` return at once. The thread sends the newest state of each subject, then
    the newest frame.

    An error of the inner sink ends its thread, and the next `send` raises it, so that the process ends instead of
    continuing without this output.
    """

    def __init__(self, sink: Sink) -> None:
        self.name = sink.name
        self._sink = sink
        self._changed = threading.Condition()  # guards what follows
        self._frame: SkeletonFrame | None = None
        self._states: dict[tuple[str, str], StateMessage] = {}
        self._displaced = 0
        self._closed = True
        self._thread = SinkThread(sink.name, self._run)

    def open(self) -> None:
        """Open the inner sink, in the caller's thread so that its errors arrive there."""
        self._sink.open()
        with self._changed:
            self._frame, self._displaced, self._closed = None, 0, False
        self._thread.start()

    def send(self, frame: SkeletonFrame) -> None:
        """Queue the frame for the thread. Raises the error that ended the thread: a MocapdError or RuntimeError."""
        self._thread.check()
        with self._changed:
            if self._closed:
                return
            self._displaced += self._frame is not None
            self._frame = frame
            self._changed.notify()

    def send_state(self, message: StateMessage) -> None:
        """Queue it for the thread, also before `open`."""
        with self._changed:
            self._states[subject(message)] = message
            self._changed.notify()

    def _run(self) -> None:
        while (waiting := self._wait_for_work()) is not None:
            states, frame = waiting
            for message in states:
                self._sink.send_state(message)
            if frame is not None:
                self._sink.send(frame)

    def _wait_for_work(self) -> tuple[tuple[StateMessage, ...], SkeletonFrame | None] | None:
        """The queued states and frame, as soon as there are any; None once closed."""
        with self._changed:
            self._changed.wait_for(lambda: self._closed or self._states or self._frame is not None)
            if self._closed:
                return None
            states, frame = tuple(self._states.values()), self._frame
            self._states.clear()
            self._frame = None
            return states, frame

    def status(self) -> SinkStatus:
        """The inner sink's status; frames displaced in the mailbox count as refused."""
        status = self._sink.status()
        with self._changed:
            dropped = self._displaced
        if not dropped:
            return status
        return replace(
            status, refused=status.refused + dropped, detail=f"{status.detail}; {dropped} too late"
        )

    def close(self) -> None:
        """End the thread, then close the inner sink; may be called twice."""
        with self._changed:
            self._closed, self._frame = True, None
            self._changed.notify()
        self._thread.join()
        self._sink.close()
