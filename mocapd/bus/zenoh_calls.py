"""Makes the interpreter's exit wait for calls into Zenoh: a thread that returns later would abort the process.

The destruction of a session or subscriber is such a call too, as Zenoh releases the GIL in it. So this module holds
references, and drops them within the next call that opens a session, or in the main thread at exit.
"""

import atexit
import threading
import weakref
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass

import zenoh

_LONGEST_S = 5.0  # longest wait at exit; calls end sooner once their session is closed


@dataclass(frozen=True, slots=True, eq=False)
class _Held:
    session: zenoh.Session
    others: tuple[object, ...]
    owner: "weakref.ref[object] | None"

    def is_needed(self) -> bool:
        return self.is_open() or (self.owner is not None and self.owner() is not None)

    def is_open(self) -> bool:
        """True also while another thread closes it."""
        try:
            return not self.session.is_closed()
        except RuntimeError:  # "Already mutably borrowed": by the call that closes it
            return True


class _Calls:
    """The calls in progress, in all threads."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._under_way, self._over = 0, False
        self._held: list[_Held] = []

    @contextmanager
    def call(self) -> Iterator[None]:
        """Context of a call. During the exit it blocks all but the main thread."""
        with self._changed:
            self._changed.wait_for(self._may_begin)
            self._under_way += 1
        try:
            yield
        finally:
            with self._changed:
                self._under_way -= 1
                self._changed.notify_all()

    def hold(self, session: zenoh.Session, *others: object, owner: object | None = None) -> None:
        """Holds a session and its declarations while it is open or the owner lives.

        Call it within `call`."""
        held = _Held(session, others, None if owner is None else weakref.ref(owner))
        with self._changed:
            self._held = [h for h in self._held if h.is_needed()] + [held]

    def end(self) -> None:
        """Waits for calls in progress, then closes the open sessions."""
        with self._changed:
            self._over = True
            self._changed.wait_for(lambda: self._under_way == 0, _LONGEST_S)
        for held in self._held:
            if held.is_open():
                with (
                    suppress(RuntimeError),
                    held.session,
                ):  # closes it, unless another thread does
                    pass

    def _may_begin(self) -> bool:
        return not self._over or threading.current_thread() is threading.main_thread()


_CALLS = _Calls()
atexit.register(_CALLS.end)  # before any session opens, so that it runs after their closing
zenoh_call = _CALLS.call
hold_session = _CALLS.hold
