"""A stream that began with what was ready first: the session that was asked for follows when all is prepared."""

from collections.abc import Callable

from mocapd.app.daemon.cache_warmup import Preparation
from mocapd.app.daemon.session_change import PREPARED, SessionChange
from mocapd.service.service import Snapshot


class EarlyStart:
    """See LoopHook. `tell` hears what is still prepared, in words for people; in the end an empty text."""

    def __init__(
        self, preparation: Preparation, change: SessionChange, tell: Callable[[str], None]
    ) -> None:
        self._preparation, self._change, self._tell = preparation, change, tell
        self._waits = not preparation.is_over

    def on_tick(self, _snapshot: Snapshot) -> None:
        """See LoopHook."""
        if not self._waits:
            return
        self._tell(self._preparation.newest())
        if self._preparation.is_over:
            self._waits = False
            self._change.ask(PREPARED)

    def let_go(self) -> None:
        """See LoopHook."""
