"""Stores the newest warning of the log, for the status report."""

import logging

from mocapd.control.control_messages import Trouble

_LONGEST = 1000  # characters


class LastTrouble(logging.Handler):
    """Receives mocapd's warnings and errors from `__enter__` to `__exit__`, if `log_level` permits them."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self._newest: Trouble | None = None

    def __enter__(self) -> "LastTrouble":
        # not at the root: its handlers are replaced when log_level changes
        logging.getLogger("mocapd").addHandler(self)
        return self

    def __exit__(self, *_: object) -> None:
        logging.getLogger("mocapd").removeHandler(self)

    def emit(self, record: logging.LogRecord) -> None:
        text = record.getMessage()[:_LONGEST]
        self._newest = Trouble(record.created, record.levelname.lower(), text)

    @property
    def newest(self) -> Trouble | None:
        """The newest warning, or None; thread-safe."""
        return self._newest
