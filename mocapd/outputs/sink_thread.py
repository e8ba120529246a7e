"""The thread of an output that is sent to by a thread of its own, and how its end is told."""

import threading
from collections.abc import Callable

from mocapd.errors import MocapdError

JOIN_S = 1.0  # how long `join` waits for a send under way [s]


class SinkThread:
    """Runs `run` from `start` on. An error of the inner sink ends it, and the next `check` raises, so that the process
    ends rather than going on without this output."""

    def __init__(self, output: str, run: Callable[[], None]) -> None:
        self._output, self._run = output, run
        self._thread: threading.Thread | None = None
        self._error: MocapdError | None = None

    def start(self) -> None:
        """Begin; after `join` once more."""
        self._error = None
        name = f"output-{self._output}"
        self._thread = threading.Thread(target=self._guarded, name=name, daemon=True)
        self._thread.start()

    def check(self) -> None:
        """Raises what ended the thread: its named error or RuntimeError."""
        if self._thread is not None and not self._thread.is_alive():
            raise self._error or RuntimeError(
                f"the thread of output {self._output} died, see above"
            )

    def join(self) -> None:
        """Wait until it has ended, which somebody told it before; may be called twice."""
        if self._thread is not None:
            self._thread.join(JOIN_S)
            self._thread = None

    def _guarded(self) -> None:
        try:
            self._run()
        except MocapdError as error:  # handed to the pipeline's thread by `check`
            self._error = error
