"""Keeps Python's cyclic garbage collector out of the frames' way."""

import gc
import threading

from mocapd.clock import NS_PER_S

YOUNG_EVERY_NS = NS_PER_S
ALL_EVERY_NS = 30 * NS_PER_S


class IdleCollection:
    """Within it, garbage is collected only when `idle` is called.

    A full collection walks every container object; with numba, zenoh and matplotlib loaded that is
    120,000 of them and 90 ms (measured), in the midst of whatever frame triggers it. So those alive
    on entry are frozen (never walked again) and what is made later, which is little, is collected
    between frames. It is the process's own setting: of several, the last to leave puts it back.
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

    def idle(self, now_ns: int) -> None:
        """Nothing is waiting: collect what is due, young objects each second, all twice a minute."""
        if self._young_ns is None or self._all_ns is None:
            self._young_ns = self._all_ns = now_ns
        if now_ns - self._all_ns >= ALL_EVERY_NS:
            gc.collect()
            self._young_ns = self._all_ns = now_ns
        elif now_ns - self._young_ns >= YOUNG_EVERY_NS:
            gc.collect(1)
            self._young_ns = now_ns
