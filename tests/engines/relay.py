"""Hands UDP datagrams on to a receiver and keeps them: what went over the wire."""

import socket
import threading
from pathlib import Path
from types import TracebackType

MOST_BYTES = 65_536
LOCALHOST = "127.0.0.1"


class Relay:
    """Listens from entering the context to leaving it. `port`: where to send to; `datagrams`: what came, in order."""

    def __init__(self, receiver_port: int) -> None:
        self._to = (LOCALHOST, receiver_port)
        self._in = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._in.bind((LOCALHOST, 0))
        self._in.settimeout(0.2)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self.port: int = self._in.getsockname()[1]
        self.datagrams: list[bytes] = []

    def __enter__(self) -> "Relay":
        self._thread.start()
        return self

    def __exit__(
        self,
        _kind: type[BaseException] | None,
        _error: BaseException | None,
        _where: TracebackType | None,
    ) -> None:
        self._ended.set()
        self._thread.join()
        self._in.close()
        self._out.close()

    def _run(self) -> None:
        while not self._ended.is_set():
            try:
                datagram = self._in.recv(MOST_BYTES)
            except TimeoutError:
                continue
            self.datagrams.append(datagram)
            self._out.sendto(datagram, self._to)


def wait_for_line(log: Path, words: str, timeout_s: float) -> bool:
    """Whether a program has printed these words into its log within the time."""
    waiting = threading.Event()
    for _ in range(round(timeout_s / 0.2)):
        if log.is_file() and words in log.read_text(errors="replace"):
            return True
        waiting.wait(0.2)
    return False
