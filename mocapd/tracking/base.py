"""The interface of every tracker."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Protocol, runtime_checkable

import numpy as np

from mocapd.body.shape import BodyShape
from mocapd.body.skeleton import N_JOINTS
from mocapd.tracking.effort import Effort
from mocapd.types import BodyState, Bytes, FrameSet, Tracking

Probe = Callable[[str], None]  # called with the name of a stage when it ends


class LostReason(StrEnum):
    """Each reason comes with a description and a remedy for the user."""

    # a person-sized region moved for seconds and failed the person checks
    UNRECOGNISED = "unrecognised"

    @property
    def what(self) -> str:
        """Description for the user."""
        return "somebody moves here who is not taken for a person"

    @property
    def fix(self) -> str:
        """Remedy for the user."""
        return "stand upright once, facing the cameras, the whole body in view of all of them"


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """A tracker's result for one frame set.

    shape: the body shape of the step, or an update learned beyond it; quality: share of the evidence that the body
    explains, 0..1, 0 when lost; lost_reason: set if the tracker knows why it tracks no person.

    evidence[camera] is an id map (h,w) uint8 over the region roi_px[camera] = x0, y0, x1, y1 of the frame, at the
    tracker's own resolution; 0 is background, 1.. are the tracker's own classes (shirt trackers: colour ids).
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
    probe: Probe  # called at the end of each stage of a step; `no_probe` by default

    def reset(self, near: BodyState | None = None) -> None:
        """Forgets everything learned since construction. near: a start pose from another tracker; used if the next frames
        confirm it."""
        ...

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        """Tracks one frame set of a wearer with this shape. Times never decrease from call to call.

        The caller owns the shape: to let the tracker learn, pass the shape of the last track to the next step. Its
        stature must be the one that the tracker was built for.
        """
        ...


@runtime_checkable
class RoomLearner(Tracker, Protocol):
    """A tracker with a background model that it can learn from a recording, even one that never shows the empty room."""

    def learn_room(self, frames: Iterable[FrameSet]) -> None:
        """Learns the static background of one recording's frame sets. Call before the first step; `reset` forgets it."""
        ...


@runtime_checkable
class LearningTracker(Tracker, Protocol):
    """A tracker that learns from a frame set after its body was published, which need not wait for that."""

    def learn(self, is_late: bool = False) -> None:
        """Learns from the frame set of the last step. Without this call the next step does so first, with the same result.

        is_late: the next frame set waits already: what can wait for another one is put off.
        """
        ...


@runtime_checkable
class EffortTracker(Tracker, Protocol):
    """A tracker that can skip optional work on a slow machine; see `tracking.effort`."""

    def set_effort(self, effort: Effort) -> None:
        """Takes effect at the next step; initially `full`. `reset` does not change it."""
        ...


def no_probe(stage: str) -> None:
    """The default probe: records nothing."""


def frozen_clock() -> int:
    """The clock for recordings: no time passes during a step [ns]."""
    return 0


def lost_body(t_ns: int, tracker: str) -> BodyState:
    """The body state while no person is tracked."""
    return BodyState(t_ns, Tracking.LOST, tracker, None, None, np.zeros(N_JOINTS))


def require_stature(shape: BodyShape, stature_m: float) -> None:
    """Raises ValueError if the shape's stature differs from the one [m] that the tracker was built for."""
    if shape.stature_m != stature_m:
        raise ValueError(f"a shape of {shape.stature_m} m for a tracker of {stature_m} m")
