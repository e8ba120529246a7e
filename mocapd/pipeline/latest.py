"""A mailbox of depth one between two threads: the newest item wins, displaced items are counted."""

import threading
from typing import Generic, TypeVar

T = TypeVar("T")


class Latest(Generic[T]):
    """Hands over the newest item. `put` never blocks; `get` waits; safe from any threads.

    After `close`, waiters wake, `get` returns None at once and `put` discards without counting.
    """

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._item: T | None = None
        self._dropped = 0
        self._closed = False

    def put(self, item: T) -> None:
        """Leave an item, displacing an unread one."""
        with self._changed:
            if self._closed:
                return
            if self._item is not None:
                self._dropped += 1
            self._item = item
            self._changed.notify()

    def get(self, timeout_s: float | None = None) -> T | None:
        """Take the item, waiting up to `timeout_s` [s] (None: for ever). None: timeout or closed."""
        with self._changed:
            self._changed.wait_for(lambda: self._closed or self._item is not None, timeout_s)
            item, self._item = self._item, None
            return item

    def close(self) -> None:
        """Wake every waiter and refuse everything further; may be called twice."""
        with self._changed:
            self._closed = True
            self._item = None
            self._changed.notify_all()

    @property
    def dropped(self) -> int:
        """Number of items displaced unread."""
        with self._changed:
            return self._dropped

    @property
    def closed(self) -> bool:
        """True after `close`: distinguishes the None of an end from that of a timeout."""
        with self._changed:
            return self._closed
