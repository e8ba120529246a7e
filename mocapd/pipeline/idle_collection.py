"""Runs Python's cyclic garbage collector between frames only."""

import gc
import threading

from mocapd.clock import NS_PER_S

YOUNG_EVERY_NS = NS_PER_S
ALL_EVERY_NS = 30 * NS_PER_S
OVERDUE_NS = 2 * ALL_EVERY_NS  # then it is collected while a frame waits, too


class IdleCollection:
    """Within this context, garbage is collected only by `idle`, to be called between frames, or when it `is_overdue`: a
    machine that is too slow has a frame waiting at any time.

    A full collection walks every container object; with numba, zenoh and matplotlib loaded these are
    120,000, and it takes 90 ms (measured) in the frame that triggers it. So the objects alive on entry
    are frozen (never walked again), and the few later ones are collected between frames. The setting
    is the process's: of several contexts, the last to exit restores it.
    """

    _lock = threading.Lock()
    _inside = 0  # guarded by it

    def __init__(self) -> None:
        self._young_ns: int | None = None  # when each was last collected
        self._all_ns: int | None = None

    def __enter__(self) -> "IdleCollection":
        with self._lock:
            IdleCollection._inside += 1
            gc.collect()
            gc.freeze()
            gc.disable()
        return self

    def __exit__(self, *_: object) -> None:
        with self._lock:
            IdleCollection._inside -= 1
            if not IdleCollection._inside:
                gc.enable()
                gc.unfreeze()

    def is_overdue(self, now_ns: int) -> bool:
        """True if nothing was collected for OVERDUE_NS."""
        if self._young_ns is None:
            self._young_ns = self._all_ns = now_ns
        return now_ns - self._young_ns >= OVERDUE_NS

    def idle(self, now_ns: int) -> None:
        """Collects young objects each second, all twice a minute."""
        if self._young_ns is None or self._all_ns is None:
            self._young_ns = self._all_ns = now_ns
        if now_ns - self._all_ns >= ALL_EVERY_NS:
            gc.collect()
            self._young_ns = self._all_ns = now_ns
        elif now_ns - self._young_ns >= YOUNG_EVERY_NS:
            gc.collect(1)
            self._young_ns = now_ns
