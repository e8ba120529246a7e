"""Rate limit for libraries' logs, which otherwise get a record for each faulty connection."""

import logging
import time

PAUSE_S = 10.0  # between two records of one message [s]
_MOST_MESSAGES = 100  # distinct ones
# uvicorn logs this for every WebSocket that is refused with an HTTP answer: the client's error, not ours.
_ORDINARY = frozenset({"ASGI callable returned without completing handshake."})


class LogLimit(logging.Filter):
    """Passes each message once in PAUSE_S, with the number of omitted ones; ordinary messages never.

    Messages are distinguished by the first line of their format: the rest has object names and addresses.
    """

    def __init__(self) -> None:
        super().__init__()
        self._passed_s: dict[str, float] = {}
        self._left_out: dict[str, int] = {}

    def filter(self, record: logging.LogRecord) -> bool:
        """True if the record is to be logged."""
        message = str(record.msg).partition("\n")[0]
        if message in _ORDINARY:
            return False
        now_s = time.monotonic()
        if now_s - self._passed_s.get(message, float("-inf")) < PAUSE_S:
            self._left_out[message] = self._left_out.get(message, 0) + 1
            return False
        if len(self._passed_s) >= _MOST_MESSAGES:
            self._passed_s.clear()
            self._left_out.clear()
        self._passed_s[message] = now_s
        if left_out := self._left_out.pop(message, 0):
            record.msg = f"{record.msg} ({left_out} more like it were left out)"
        return True


def limit_logs() -> None:
    """Limit what asyncio and uvicorn log, once for the whole process."""
    for name in ("asyncio", "uvicorn.error"):
        logger = logging.getLogger(name)
        if not any(isinstance(log_filter, LogLimit) for log_filter in logger.filters):
            logger.addFilter(LogLimit())
