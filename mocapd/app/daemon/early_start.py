"""Early start: the stream begins with a reduced session; the configured one follows when everything is prepared."""

from collections.abc import Callable

from mocapd.app.daemon.cache_warmup import Preparation
from mocapd.app.daemon.session_change import PREPARED, SessionChange
from mocapd.service.service import Snapshot


class EarlyStart:
    """See LoopHook, of an early session. Reports the remaining preparations, for users; an empty text at the end, also
    where that came before the first tick."""

    def __init__(
        self, preparation: Preparation, change: SessionChange, report: Callable[[str], None]
    ) -> None:
        self._preparation, self._change, self._report = preparation, change, report
        self._waits = True

    def on_tick(self, _snapshot: Snapshot) -> None:
        if not self._waits:
            return
        self._waits = not self._preparation.is_over
        self._report(self._preparation.newest() if self._waits else "")
        if not self._waits:
            self._change.ask(PREPARED)

    def let_go(self) -> None:
        """See LoopHook."""
