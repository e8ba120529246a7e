"""Sends predicted poses to an output at a fixed rate, which may be higher than the cameras'."""

import itertools
import threading

import msgspec

from mocapd.clock import NS_PER_S, monotonic_ns, nanoseconds, seconds
from mocapd.errors import MocapdError
from mocapd.outputs.base import Sink, SinkStatus
from mocapd.outputs.messages import StateMessage
from mocapd.outputs.prediction.pose_predictor import PosePredictor
from mocapd.outputs.wire import SkeletonFrame

_SILENT_NS = NS_PER_S // 4  # time since the newest frame after which nothing is sent
_JOIN_S = 1.0  # how long `close` waits for a send under way [s]


class PredictedSink:
    """Wraps any sink. `send` and `send_state` return at once; a thread sends the pose of `ahead_s` from now `rate_hz`
    times a second. `lost` is sent once, on arrival.

    Predicted frames have sequence numbers of their own. An error of the inner sink ends the thread, and the next
    `send` raises it, so that the process ends instead of continuing without this output.
    """

    def __init__(self, sink: Sink, rate_hz: float, ahead_s: float) -> None:
        self.name = sink.name
        self._sink = sink
        self._period_ns, self._ahead_ns = round(NS_PER_S / rate_hz), nanoseconds(ahead_s)
        self._seq = itertools.count()
        self._changed = threading.Condition()  # guards what follows
        self._frames: list[SkeletonFrame] = []
        self._closed = True
        self._thread: threading.Thread | None = None
        self._error: MocapdError | None = None

    def open(self) -> None:
        """Open the inner sink, in the caller's thread so that its errors arrive there."""
        self._sink.open()
        with self._changed:
            self._frames, self._closed = [], False
        self._error = None
        self._thread = threading.Thread(target=self._run, name=f"output-{self.name}", daemon=True)
        self._thread.start()

    def send(self, frame: SkeletonFrame) -> None:
        """Queue the frame for the thread. Raises the error that ended the thread: a MocapdError or RuntimeError."""
        if self._thread is not None and not self._thread.is_alive():
            raise self._error or RuntimeError(f"the thread of output {self.name} died, see above")
        with self._changed:
            if not self._closed:
                self._frames.append(frame)

    def send_state(self, message: StateMessage) -> None:
        """Pass it to the inner sink."""
        self._sink.send_state(message)

    def status(self) -> SinkStatus:
        """The inner sink's status."""
        return self._sink.status()

    def close(self) -> None:
        """End the thread, then close the inner sink; may be called twice."""
        with self._changed:
            self._closed = True
            self._changed.notify()
        if self._thread is not None:
            self._thread.join(_JOIN_S)
            self._thread = None
        self._sink.close()

    def _run(self) -> None:
        try:
            self._send_predicted()
        except MocapdError as error:  # `send` raises it in the pipeline's thread
            self._error = error

    def _send_predicted(self) -> None:
        predictor = PosePredictor()
        newest: SkeletonFrame | None = None
        due_ns = monotonic_ns()
        while (frames := self._came_until(due_ns)) is not None:
            for frame in frames:
                predictor.take(frame)
                newest = frame
            now_ns = monotonic_ns()
            if newest is not None and (newest.joints or frames):
                self._send(predictor, newest, now_ns)
            # after a pause the schedule restarts from now, without catching up
            due_ns = max(due_ns + self._period_ns, now_ns)

    def _came_until(self, due_ns: int) -> list[SkeletonFrame] | None:
        """The frames that arrive until then; None once closed."""
        with self._changed:
            wait_s = max(0.0, seconds(due_ns - monotonic_ns()))
            if self._changed.wait_for(lambda: self._closed, wait_s):
                return None
            frames, self._frames = self._frames, []
            return frames

    def _send(self, predictor: PosePredictor, newest: SkeletonFrame, now_ns: int) -> None:
        if now_ns - newest.publish_monotonic_ns > _SILENT_NS:
            return
        to_unix = newest.capture_unix_ns - newest.capture_monotonic_ns
        frame = predictor.at(now_ns + self._ahead_ns + to_unix)
        assert frame is not None
        self._sink.send(
            msgspec.structs.replace(frame, seq=next(self._seq), publish_monotonic_ns=now_ns)
        )
