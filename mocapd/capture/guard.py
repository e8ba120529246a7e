"""A cv2.VideoCapture that one thread reads and any thread may close.

Releasing a VideoCapture while another thread is inside `grab` crashes, or blocks as long as the grab. So `close` never
waits: a reader that is inside releases the capture when it leaves. A capture whose opening was closed or superseded
meanwhile is released at once.
"""

import threading

import mocapd.capture.environment  # noqa: F401  isort: skip  before cv2

import cv2


class GuardedCapture:
    """Holds an opened VideoCapture; `with guarded as capture:` gives it to the one reading thread."""

    def __init__(self, capture: cv2.VideoCapture) -> None:
        self._capture = capture
        self._inside = threading.Lock()
        self._closing = False

    @property
    def closing(self) -> bool:
        """Whether `close` was called."""
        return self._closing

    def close(self) -> None:
        """Releases the capture now, or when the reader leaves. Never blocks; idempotent."""
        self._closing = True
        self._release_if_free()

    def _release_if_free(self) -> None:
        if self._inside.acquire(blocking=False):
            try:
                self._capture.release()
            finally:
                self._inside.release()

    def __enter__(self) -> cv2.VideoCapture:
        self._inside.acquire()
        return self._capture

    def __exit__(self, *_: object) -> None:
        self._inside.release()
        if self._closing:  # asked for while we were inside
            self._release_if_free()


class Openings:
    """The current capture of a source: the newest opening wins. Thread-safe."""

    def __init__(self) -> None:
        self._lock = threading.Lock()  # guards what follows
        self._begun = 0
        self._current: GuardedCapture | None = None

    @property
    def current(self) -> GuardedCapture | None:
        """The open capture; None before an opening and after `close`."""
        return self._current

    def begin(self) -> int:
        """Begins an opening and closes the previous one. Returns its number, for `take`."""
        self.close()
        return self._begun

    def take(self, number: int, capture: cv2.VideoCapture) -> bool:
        """Installs the capture of an opening. Releases it and returns False if that opening was closed meanwhile."""
        with self._lock:
            if number == self._begun:
                self._current = GuardedCapture(capture)
                return True
        capture.release()
        return False

    def close(self) -> None:
        """Closes the current capture. Never blocks; idempotent."""
        with self._lock:
            self._begun += 1
            current, self._current = self._current, None
        if current is not None:
            current.close()
