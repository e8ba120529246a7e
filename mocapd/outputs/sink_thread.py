"""The thread of an output, and the report of its error to the sending thread."""

import threading
from collections.abc import Callable

from mocapd.errors import MocapdError

JOIN_S = 1.0  # how long `join` waits for a send under way [s]


class SinkThread:
    """Runs `run` in a thread. A MocapdError ends it, and the next `check` raises that error, so that the process ends
    instead of continuing without this output."""

    def __init__(self, output: str, run: Callable[[], None]) -> None:
        self._output, self._run = output, run
        self._thread: threading.Thread | None = None
        self._error: MocapdError | None = None

    def start(self) -> None:
        """Start the thread, also again after `join`."""
        self._error = None
        name = f"output-{self._output}"
        self._thread = threading.Thread(target=self._run_and_store_error, name=name, daemon=True)
        self._thread.start()

    def check(self) -> None:
        """Raises the error that ended the thread: a MocapdError or RuntimeError."""
        if self._thread is not None and not self._thread.is_alive():
            raise self._error or RuntimeError(
                f"the thread of output {self._output} died, see above"
            )

    def join(self) -> None:
        """Wait for its end, which the caller requested before; may be called twice."""
        if self._thread is not None:
            self._thread.join(JOIN_S)
            self._thread = None

    def _run_and_store_error(self) -> None:
        try:
            self._run()
        except MocapdError as error:  # `check` raises it in the pipeline's thread
            self._error = error
