"""The interface of every tracker."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

import numpy as np

from mocapd.body.shape import BodyShape
from mocapd.body.skeleton import N_JOINTS
from mocapd.tracking.effort import Effort
from mocapd.tracking.lost_reason import LostReason
from mocapd.types import BodyState, Bytes, FrameSet, Tracking

Probe = Callable[[str], None]  # hears that the stage of this name has ended


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """What a tracker says of one frame set.

    shape: the wearer's as known now, that of the step or what was learned beyond it; quality: how much
    of the evidence the body explains, 0..1, 0 when lost; lost_reason: why nobody is tracked, where the tracker can tell.

    evidence[camera] is an id map (h,w) uint8 over the region roi_px[camera] = x0, y0, x1, y1 of
    the frame, at the tracker's own resolution; 0 is nothing, 1.. are the tracker's own classes
    (shirt trackers: colour ids).
    """

    body: BodyState
    shape: BodyShape
    quality: float = 0.0
    evidence: Mapping[str, Bytes] = field(default_factory=dict)
    roi_px: Mapping[str, tuple[int, int, int, int]] = field(default_factory=dict)
    lost_reason: LostReason | None = None


class Tracker(Protocol):
    """A pure step machine: no threads, no clock, no I/O.

    Promises, each tested on every registered tracker: time comes only from `frames.t_ns` and the
    frames' own `t_ns`; the same frames and shapes after `reset()` give the same output; a missing camera
    or an empty room gives `lost`, never an exception; frames are not written to. The joints of a body are
    those of `skeleton_of(track.shape)` in its pose.
    """

    name: str
    probe: Probe  # called at the end of each stage of a step; `unprobed` for nobody

    def reset(self, near: BodyState | None = None) -> None:
        """Forget everything learned since construction. near: begin from this body, as another tracker
        knew it; it is believed when the next frames confirm it."""
        ...

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        """Track one frame set of a wearer of this shape; times never decrease from call to call.

        Whoever steps it owns the shape: to let the tracker learn, hand the shape of the last track to
        the next step. Its stature is the one that the tracker was built for.
        """
        ...


@runtime_checkable
class RoomLearner(Tracker, Protocol):
    """A tracker that has to know the empty room, and can learn it from a recording that never shows it empty."""

    def learn_room(self, frames: Iterable[FrameSet]) -> None:
        """Before the first step: what stays as it is in these frame sets of one recording is the room. `reset` forgets
        it."""
        ...


@runtime_checkable
class EffortTracker(Tracker, Protocol):
    """A tracker that can leave out work where a machine is too slow; see `tracking.effort`."""

    def set_effort(self, effort: Effort) -> None:
        """From the next step on; `full` at first. `reset` leaves it as it is."""
        ...


def unprobed(stage: str) -> None:
    """Nobody measures."""


def no_time_passes() -> int:
    """The clock of recordings, which wait as long as a step takes [ns]."""
    return 0


def lost_body(t_ns: int, tracker: str) -> BodyState:
    """Nobody is known."""
    return BodyState(t_ns, Tracking.LOST, tracker, None, None, np.zeros(N_JOINTS))


def require_stature(shape: BodyShape, stature_m: float) -> None:
    """Raises ValueError when a tracker that was built for this stature [m] is stepped with another's shape."""
    if shape.stature_m != stature_m:
        raise ValueError(f"a shape of {shape.stature_m} m for a tracker of {stature_m} m")
