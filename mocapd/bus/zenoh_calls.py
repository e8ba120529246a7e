"""Calls into Zenoh that the interpreter's exit waits for: a thread that came back later would abort it.

The end of a session's or subscriber's object is such a call too: Zenoh lets go of the interpreter meanwhile. So they are
held here, and let go of within the next call that opens one, or by the main thread as the last of all.
"""

import atexit
import threading
import weakref
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass

import zenoh

_LONGEST_S = 5.0  # that the exit waits; what is called takes less once its session is closed


@dataclass(frozen=True, slots=True, eq=False)
class _Held:
    session: zenoh.Session
    others: tuple[object, ...]
    owner: "weakref.ref[object] | None"

    def is_needed(self) -> bool:
        return self.is_open() or (self.owner is not None and self.owner() is not None)

    def is_open(self) -> bool:
        """Also while another thread is closing it."""
        try:
            return not self.session.is_closed()
        except RuntimeError:  # "Already mutably borrowed": by the call that closes it
            return True


class _Calls:
    """Those under way, in all threads."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._under_way, self._over = 0, False
        self._held: list[_Held] = []

    @contextmanager
    def one(self) -> Iterator[None]:
        """Around a call. While the interpreter exits only the main thread gets that far."""
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
        """A session that was opened, and what was declared in it, for as long as it is open or the owner lives.
        To be called within a call."""
        held = _Held(session, others, None if owner is None else weakref.ref(owner))
        with self._changed:
            self._held = [one for one in self._held if one.is_needed()] + [held]

    def end(self) -> None:
        """Wait for those under way, and close what they left open."""
        with self._changed:
            self._over = True
            self._changed.wait_for(lambda: self._under_way == 0, _LONGEST_S)
        for one in self._held:
            if one.is_open():
                with (
                    suppress(RuntimeError),
                    one.session,
                ):  # which closes it, unless another thread does
                    pass

    def _may_begin(self) -> bool:
        return not self._over or threading.current_thread() is threading.main_thread()


_CALLS = _Calls()
atexit.register(_CALLS.end)  # before any session is open, so that it comes after their closing

zenoh_call = _CALLS.one
hold_session = _CALLS.hold
