"""A slow sink on a thread of its own, behind a mailbox of the newest frame and the newest of each state."""

import threading
from dataclasses import replace

from mocapd.outputs.base import Sink, SinkStatus
from mocapd.outputs.messages import StateMessage, subject
from mocapd.outputs.sink_thread import SinkThread
from mocapd.outputs.wire import SkeletonFrame


class ThreadedSink:
    """Wraps any sink: `send` and `tell` return at once. Of the frames that pile up the newest is sent, of the
    states the newest about each subject, and these first.

    An error of the inner sink ends its thread, and the next `send` raises, so that the process ends
    rather than going on without this output.
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
        """Leave the frame for the thread. Raises what ended it: its named error or RuntimeError."""
        self._thread.check()
        with self._changed:
            if self._closed:
                return
            self._displaced += self._frame is not None
            self._frame = frame
            self._changed.notify()

    def tell(self, message: StateMessage) -> None:
        """Leave it for the thread; before `open`, for the one to come."""
        with self._changed:
            self._states[subject(message)] = message
            self._changed.notify()

    def _run(self) -> None:
        while (waiting := self._taken()) is not None:
            states, frame = waiting
            for message in states:
                self._sink.tell(message)
            if frame is not None:
                self._sink.send(frame)

    def _taken(self) -> tuple[tuple[StateMessage, ...], SkeletonFrame | None] | None:
        """What waits, as soon as something does; None when it is closed."""
        with self._changed:
            self._changed.wait_for(lambda: self._closed or self._states or self._frame is not None)
            if self._closed:
                return None
            states, frame = tuple(self._states.values()), self._frame
            self._states.clear()
            self._frame = None
            return states, frame

    def status(self) -> SinkStatus:
        """The inner sink's; frames displaced in the mailbox count as refused."""
        status = self._sink.status()
        with self._changed:
            dropped = self._displaced
        if not dropped:
            return status
        return replace(
            status, refused=status.refused + dropped, detail=f"{status.detail}; {dropped} too late"
        )

    def close(self) -> None:
        """Let the thread go, then close the inner sink; may be called twice."""
        with self._changed:
            self._closed, self._frame = True, None
            self._changed.notify()
        self._thread.join()
        self._sink.close()
