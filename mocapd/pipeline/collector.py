"""Between the capture threads and the pipeline's thread: bundles frames on arrival, stores the newest set."""

import threading
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from mocapd.clock import monotonic_ns, nanoseconds, seconds
from mocapd.pipeline.bundler import Bundler, BundlerParams, CameraCounts
from mocapd.pipeline.rolling import RollingRate
from mocapd.types import Frame, FrameSet


@dataclass(frozen=True, slots=True)
class CollectorCounts:
    """`sets`: frame sets made; `dropped`: those displaced by a newer one before they were fetched.

    Per camera: frame counts, and frames arriving per second [Hz].
    """

    sets: int
    dropped: int
    cameras: dict[str, CameraCounts]
    rates_hz: dict[str, float]


class FrameCollector:
    """The mailbox of a whole rig: any thread puts frames, one thread takes frame sets.

    Frames are bundled in the thread that puts them (some forty microseconds), so pairing continues
    while the pipeline computes, and the pipeline then gets the newest complete set. Dropping single
    frames instead would break the pairs.
    """

    def __init__(
        self,
        camera_names: Iterable[str],
        params: BundlerParams | None = None,
        clock: Callable[[], int] = monotonic_ns,
    ) -> None:
        names = tuple(camera_names)
        self._bundler = Bundler(names, params)
        self._rates = {name: RollingRate() for name in names}
        self._clock = clock
        self._changed = threading.Condition()  # guards everything below and the bundler
        self._ready: FrameSet | None = None
        self._sets = 0
        self._dropped = 0
        self._closed = False

    def put(self, frame: Frame) -> None:
        """Add a frame; never blocks. Frames of other cameras of a hub are ignored."""
        with self._changed:
            if self._closed or frame.camera not in self._rates:
                return
            deadline_ns = self._bundler.deadline_ns
            now_ns = self._clock()
            self._keep(self._bundler.add(frame, now_ns))
            self._rates[frame.camera].add(now_ns)
            if self._ready is not None or self._bundler.deadline_ns != deadline_ns:
                self._changed.notify()

    def get(self, timeout_s: float | None = None) -> FrameSet | None:
        """The newest frame set, waiting up to `timeout_s` [s]. None: timeout, or closed."""
        give_up_ns = None if timeout_s is None else self._clock() + nanoseconds(timeout_s)
        with self._changed:
            while not self._closed:
                now_ns = self._clock()
                self._keep(self._bundler.flush(now_ns))
                if self._ready is not None or (give_up_ns is not None and now_ns >= give_up_ns):
                    break
                ends = [t for t in (give_up_ns, self._bundler.deadline_ns) if t is not None]
                self._changed.wait(seconds(min(ends) - now_ns) if ends else None)
            newest, self._ready = self._ready, None
            return newest

    @property
    def sets(self) -> int:
        """Number of frame sets made so far."""
        with self._changed:
            return self._sets

    @property
    def idle(self) -> bool:
        """True if no frame set is ready."""
        with self._changed:
            return self._ready is None

    @property
    def closed(self) -> bool:
        """True after `close`."""
        with self._changed:
            return self._closed

    def close(self) -> None:
        """Wake the waiter and refuse everything further; may be called twice."""
        with self._changed:
            self._closed = True
            self._ready = None
            self._changed.notify_all()

    def counts(self) -> CollectorCounts:
        """Counts of the sets and of each camera's frames so far."""
        with self._changed:
            now_ns = self._clock()
            return CollectorCounts(
                self._sets,
                self._dropped,
                self._bundler.counts(),
                {name: rate.rate_hz(now_ns) for name, rate in self._rates.items()},
            )

    def _keep(self, sets: tuple[FrameSet, ...]) -> None:
        for newest in sets:
            self._sets += 1
            if self._ready is not None:
                self._dropped += 1
            self._ready = newest
