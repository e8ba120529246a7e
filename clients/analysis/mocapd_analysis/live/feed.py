"""Frames of a running daemon, on a thread of their own; says in a line how that goes."""

import threading
import time

import mocapd.client
from mocapd.errors import InputError, MocapdError
from mocapd_analysis.live.buffer import LiveBuffer
from mocapd_analysis.measures import measure
from mocapd_analysis.viewer.moment import Moment

SILENT_S = 1.0  # without a frame, before it is said
MEASURED_EVERY_S = 0.5  # all measures of a minute take some tenths of a second


class LiveFeed:
    """Connects, and connects again when the daemon goes; `moment` is what there is now."""

    def __init__(self, endpoint: str, person: int) -> None:
        self._link = mocapd.client.Link(
            endpoint=endpoint, person=person, connect_timeout_s=1.0, typed_options=True
        )
        self._lock = threading.Lock()
        self._buffer = LiveBuffer(f"person {person}")  # under the lock
        self._status = f"waiting for mocapd at {endpoint}"  # under the lock
        self._newest_s = 0.0  # under the lock
        self._moment = Moment((), self._status, is_live=True)
        self._measured_s = 0.0
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._listen, name="live feed", daemon=True)

    def start(self) -> None:
        """Begin to listen."""
        self._thread.start()

    def stop(self) -> None:
        """End the thread, which looks every tenth of a second."""
        self._stopping.set()
        self._thread.join(timeout=5.0)

    def moment(self) -> Moment:
        """The sessions as of now; the same ones until there is something new. On the viewer's thread."""
        now_s = time.monotonic()
        with self._lock:
            status, is_new = self._status, self._newest_s > self._measured_s
            silent_s = now_s - self._newest_s
            session = None
            if is_new and now_s - self._measured_s >= MEASURED_EVERY_S:
                self._measured_s = now_s
                try:
                    session = self._buffer.session()
                except InputError as error:  # a body of other joints
                    status += f"  \n**{error}**"
        if not is_new and self._measured_s > 0.0 and silent_s > SILENT_S:
            status += f"  \n**no frame for {silent_s:.0f} s**"
        sessions = self._moment.sessions if session is None else (measure(session),)
        self._moment = Moment(sessions, status, is_live=True)
        return self._moment

    def _listen(self) -> None:
        while not self._stopping.is_set():
            try:
                with mocapd.client.Client(self._link) as client:
                    self._say(f"live from {self._link.endpoint}")
                    self._take_from(client)
            except MocapdError as error:
                self._say(f"{error}  \ntrying again")
                self._stopping.wait(1.0)

    def _take_from(self, client: mocapd.client.Client) -> None:
        """Raises MocapdError, also for a frame of another version: the next attempt says so again."""
        while not self._stopping.is_set():
            body = client.wait(0.1)
            if body is None:
                continue
            with self._lock:
                if self._buffer.add(body.frame):
                    self._newest_s = time.monotonic()
            lost = "" if body.tracked else "; **nobody is tracked**"
            self._say(
                f"live from {self._link.endpoint}, {body.latency_s * 1e3:.0f} ms from exposure to "
                f"publishing{lost}"
            )

    def _say(self, words: str) -> None:
        with self._lock:
            self._status = words
