"""A slow sink on a thread of its own, behind a mailbox of depth one."""

import threading
from dataclasses import replace

from mocapd.errors import MocapdError
from mocapd.outputs.base import Sink, SinkStatus
from mocapd.outputs.wire import SkeletonFrame
from mocapd.pipeline.latest import Latest

JOIN_S = 1.0  # how long `close` waits for a send under way [s]


class ThreadedSink:
    """Wraps any sink: `send` returns at once, and of the frames that pile up the newest is sent.

    An error of the inner sink ends its thread, and the next `send` raises, so that the process ends
    rather than going on without this output.
    """

    def __init__(self, sink: Sink) -> None:
        self.name = sink.name
        self._sink = sink
        self._mailbox: Latest[SkeletonFrame] = Latest()
        self._thread: threading.Thread | None = None
        self._error: MocapdError | None = None

    def open(self) -> None:
        """Open the inner sink, in the caller's thread so that its errors arrive there."""
        self._sink.open()
        self._mailbox = Latest()
        self._error = None
        self._thread = threading.Thread(target=self._run, name=f"output-{self.name}", daemon=True)
        self._thread.start()

    def send(self, frame: SkeletonFrame) -> None:
        """Leave the frame for the thread. Raises what ended it: its named error or RuntimeError."""
        if self._thread is not None and not self._thread.is_alive():
            raise self._error or RuntimeError(f"the thread of output {self.name} died, see above")
        self._mailbox.put(frame)

    def _run(self) -> None:
        mailbox = self._mailbox
        try:
            while (frame := mailbox.get()) is not None:
                self._sink.send(frame)
        except MocapdError as error:  # handed to the pipeline's thread by `send`
            self._error = error

    def status(self) -> SinkStatus:
        """The inner sink's; frames displaced in the mailbox count as refused."""
        status = self._sink.status()
        dropped = self._mailbox.dropped
        if not dropped:
            return status
        return replace(
            status, refused=status.refused + dropped, detail=f"{status.detail}; {dropped} too late"
        )

    def close(self) -> None:
        """Let the thread go, then close the inner sink; may be called twice."""
        self._mailbox.close()
        if self._thread is not None:
            self._thread.join(JOIN_S)
            self._thread = None
        self._sink.close()
