"""Maps the stamps of one camera's pictures to a time common to all cameras."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.calibrate.time_alignment.offset_search import PairOffsets
from mocapd.types import Floats

_UNSURE = 2.1  # steps between pictures around a jump, the uncertainty of its time


@dataclass(frozen=True, slots=True, eq=False)
class ClockMap:
    """A picture stamped s [s] was taken at s - offset_s[j] in the time of another camera, in stretch j of it.

    jump_s (J,): ends of stretches in that time, with an uncertainty of unsure_s; offset_s (J+1,).
    """

    jump_s: Floats
    offset_s: Floats
    unsure_s: float = 0.0

    def times(self, stamps_s: Floats) -> tuple[Floats, NDArray[np.bool_]]:
        """(N,) [s] in the other camera's time, and which of them are reliable: far enough from jumps."""
        starts = np.concatenate([[-np.inf], self.jump_s])
        ends = np.concatenate([self.jump_s, [np.inf]])
        out = np.full(len(stamps_s), np.nan)
        for start_s, end_s, offset_s in zip(starts, ends, self.offset_s, strict=True):
            time_s = stamps_s - offset_s
            inside = (time_s >= start_s + self.unsure_s) & (time_s < end_s - self.unsure_s)
            out[inside] = time_s[inside]
        return out, np.isfinite(out)

    @property
    def changes_s(self) -> Floats:
        """(J,): by how much the offset changes at each jump."""
        return np.diff(self.offset_s)


SAME_CLOCK = ClockMap(np.zeros(0), np.zeros(1))


def clock_map(offsets: PairOffsets) -> ClockMap:
    """From b's stamps to a's time; each jump half-way between two pictures of a."""
    rows, times_s = offsets.jumps, offsets.times_s
    at_s = 0.5 * (times_s[rows] + times_s[np.maximum(rows - 1, 0)])
    unsure_s = _UNSURE * float(np.median(np.diff(times_s)))
    return ClockMap(at_s, offsets.offset_s[np.concatenate([[0], rows]).astype(int)], unsure_s)
