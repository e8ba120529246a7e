"""Rate-limited log lines in place of what picture decoders write to C's stderr.

libjpeg writes a line for each damaged picture, so one camera could fill the disk, and OpenCV cannot silence it. So C's
stream `stderr` is redirected to a pipe. The interpreter's own stderr, and what Rust and faulthandler write to file
descriptor 2, are unaffected.
"""

import ctypes
import logging
import os
import platform
import threading
import time
from contextlib import suppress
from types import TracebackType

from mocapd.errors import one_line

_LOG = logging.getLogger(__name__)

PAUSE_S = 10.0  # between two lines of the log [s]
_READ_BYTES = 65_536
_LONGEST = 200  # characters of a line
_LAST_LINE_S = 1.0  # until it is logged
_END = b"\0"  # no decoder writes it
_UNBUFFERED = 2  # _IONBF of stdio.h


class DecoderWarnings:
    """Context manager with a thread of its own. Does nothing without glibc, where `stderr` is no variable."""

    def __init__(self, pause_s: float = PAUSE_S) -> None:
        self._pause_s = pause_s
        self._stream: ctypes.c_void_p | None = None
        self._before: int | None = None
        self._thread = threading.Thread(target=self._run, name="decoder-warnings", daemon=True)

    def __enter__(self) -> "DecoderWarnings":
        if platform.libc_ver()[0] != "glibc":
            return self
        libc = ctypes.CDLL(None)
        libc.fdopen.restype = ctypes.c_void_p
        libc.setvbuf.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_size_t]
        self._read_fd, self._write_fd = os.pipe2(os.O_CLOEXEC)
        os.set_blocking(self._write_fd, False)  # a decoder must not wait for our thread
        file = libc.fdopen(self._write_fd, b"w")
        libc.setvbuf(file, None, _UNBUFFERED, 0)
        self._stream = ctypes.c_void_p.in_dll(libc, "stderr")
        self._before, self._stream.value = self._stream.value, file
        self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        if self._stream is None:
            return
        self._stream.value = self._before
        # The file stays open: a decoder in another thread may be writing to it.
        with suppress(BlockingIOError):
            os.write(self._write_fd, _END)
        self._thread.join(_LAST_LINE_S)

    def _run(self) -> None:
        logged_s, left_out = float("-inf"), 0
        while data := os.read(self._read_fd, _READ_BYTES):
            lines = data.rstrip(_END).splitlines()
            if lines and time.monotonic() - logged_s >= self._pause_s:
                logged_s = time.monotonic()
                more = left_out + len(lines) - 1
                counted = f" ({more} more like it were left out)" if more else ""
                text = one_line(lines[0].decode(errors="replace"))[:_LONGEST]
                _LOG.warning("a picture of a camera is damaged: %s%s", text, counted)
                left_out = 0
            else:
                left_out += len(lines)
            if data.endswith(_END):
                return
