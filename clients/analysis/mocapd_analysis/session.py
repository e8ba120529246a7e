"""One person's motion as it is analysed: frames at their own times, and where tracking was lost between them."""

import itertools
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mocapd.types import Floats, Ints

Flags = NDArray[np.bool_]

# Two frames that lie farther apart are not joined: what happened between them is not known. Three
# frames at 30 Hz may be missing; a swing's speed stays within a few percent over so short a hole.
LONGEST_JOINED_S = 0.12
SHORTEST_SEGMENT = 5  # frames; of fewer nothing can be said about speed
LEAST_CONFIDENCE = 0.1  # of a joint in a frame; below, the tracker had next to no evidence


@dataclass(frozen=True, eq=False)  # without slots: what is cached lies beside the fields
class Session:
    """F frames of J joints in the world of mocapd (right-handed, +Y up, metres); F is one at least.

    times_s (F,): since the first frame, increasing [s]; joints_m (F,J,3) [m]; confidence (F,J) 0..1; notes: what
    was wrong with the recording, a line each for people; recorded_unix_s: the first frame's time [Unix, s], where the
    file says it.
    """

    name: str
    joint_names: tuple[str, ...]
    parents: Ints
    times_s: Floats
    joints_m: Floats
    confidence: Floats
    notes: tuple[str, ...] = ()
    recorded_unix_s: float | None = None

    def joint(self, name: str) -> int:
        """The place of a joint; KeyError where this session has none of that name."""
        try:
            return self.joint_names.index(name)
        except ValueError:
            raise KeyError(name) from None

    def has(self, *names: str) -> bool:
        """Whether all of these joints are there."""
        return all(name in self.joint_names for name in names)

    def positions_m(self, name: str) -> Floats:
        """A joint's way (F,3) [m]."""
        return self.joints_m[:, self.joint(name)]

    def is_seen(self, *names: str) -> Flags:
        """In which frames (F,) the tracker had evidence of all of these joints."""
        where = [self.joint(name) for name in names]
        seen: Flags = np.all(self.confidence[:, where] >= LEAST_CONFIDENCE, axis=1)
        return seen

    @property
    def duration_s(self) -> float:
        """From the first frame to the last [s]."""
        return float(self.times_s[-1] - self.times_s[0])

    @property
    def rate_hz(self) -> float:
        """Frames a second by the median of their distances [Hz]; 0 for a single frame."""
        return 0.0 if len(self.times_s) < 2 else 1.0 / float(np.median(np.diff(self.times_s)))

    @cached_property
    def segments(self) -> tuple[slice, ...]:
        """Runs of frames without a gap, in order; short ones too."""
        return segments_of(self.times_s)

    @cached_property
    def gaps_s(self) -> tuple[tuple[float, float], ...]:
        """Start and end of each time without a frame [s]."""
        parts = self.segments
        return tuple(
            (float(self.times_s[one.stop - 1]), float(self.times_s[after.start]))
            for one, after in itertools.pairwise(parts)
        )


def segments_of(times_s: Floats) -> tuple[slice, ...]:
    """Runs of frames (F,) without a gap; a slow recording's own distance is none."""
    if len(times_s) == 0:
        return ()
    steps_s = np.diff(times_s)
    usual_s = float(np.median(steps_s)) if len(steps_s) else 0.0
    ends = np.flatnonzero(steps_s > max(LONGEST_JOINED_S, 2.5 * usual_s)) + 1
    starts = [0, *ends.tolist()]
    return tuple(
        slice(start, stop)
        for start, stop in zip(starts, [*ends.tolist(), len(times_s)], strict=True)
    )
