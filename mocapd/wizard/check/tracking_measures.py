"""Queue of a tracker's measures from the pipeline's thread to the wizard's."""

import threading
from dataclasses import dataclass, field

from mocapd.calibrate.verification.check_measure import Measure


@dataclass(slots=True, eq=False)
class TrackingMeasures:
    """Written by the pipeline's thread, read by the wizard's."""

    _lock: threading.Lock = field(default_factory=threading.Lock)
    _all: list[Measure] = field(default_factory=list)

    def add(self, measure: Measure) -> None:
        with self._lock:
            self._all.append(measure)

    def take(self) -> tuple[Measure, ...]:
        """New measures since the last call."""
        with self._lock:
            out, self._all = tuple(self._all), []
            return out
