"""Track a recorded capture: every frame in order, as fast as the tracker goes; and the track's file."""

import os
import tempfile
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mocapd.body.shape import BodyShape, skeleton_of
from mocapd.clock import seconds
from mocapd.errors import CannotCreateError, ConfigError
from mocapd.trackers.base import RoomLearner, Tracker
from mocapd.trackers.lost_reason import LostReason
from mocapd.types import Floats, FrameSet
from mocapd.whole_file import whole_file

SCHEMA = "mocapd.Track.v1"
_ROOM_LOOKS = 60  # pictures of each camera from which a room is learned: they are kept meanwhile


@dataclass(frozen=True, slots=True, eq=False)
class RecordedTrack:
    """F frames of J joints; frames in which nobody was tracked are absent.

    times_s (F,): since the capture's start [s]; joints_m (F,J,3) [m, world]; global_xyzw (F,J,4):
    rotations relative to the T-pose; confidence (F,J) 0..1; tracker (F,); uncertainty_m (F,J): as in BodyState,
    inf where it is unknown, and everywhere when left out; unrecognised: frames in which somebody moves who is not taken for a
    person.
    """

    times_s: Floats
    joint_names: tuple[str, ...]
    joints_m: Floats
    global_xyzw: Floats
    confidence: Floats
    tracker: NDArray[np.str_]
    uncertainty_m: Floats = field(default_factory=lambda: np.empty((0, 0)))
    unrecognised: int = 0

    def __post_init__(self) -> None:
        if self.uncertainty_m.size == 0:
            object.__setattr__(self, "uncertainty_m", np.full(self.confidence.shape, np.inf))


def learn_room(tracker: Tracker, frames: Iterable[FrameSet], count: int) -> None:
    """Let a tracker learn the empty room from some of the frame sets of a recording, of which there are about `count`. Raises
    ConfigError when it learns none."""
    if not isinstance(tracker, RoomLearner):
        raise ConfigError(
            f"the tracker {tracker.name!r} learns no room", "--room", "leave it out, or add --tracker flex"
        )  # fmt: skip
    tracker.learn_room(islice(frames, None, None, max(1, -(-count // _ROOM_LOOKS))))


def track_all(
    tracker: Tracker, shape: BodyShape, frames: Iterable[FrameSet], on_frame: Callable[[int], None]
) -> RecordedTrack:
    """Step the tracker through all frame sets of a wearer of this shape; `on_frame` is told how many are done."""
    names = skeleton_of(shape).names
    times, joints, quats, confidence, by, uncertainty = [], [], [], [], [], []
    unrecognised = 0
    for done, one in enumerate(frames, start=1):
        track = tracker.step(one, shape)
        body, shape = track.body, track.shape
        unrecognised += track.lost_reason is LostReason.UNRECOGNISED
        if body.pose is not None and body.joints_m is not None:
            times.append(seconds(body.t_ns))
            joints.append(body.joints_m)
            quats.append(body.pose.quats_xyzw)
            confidence.append(body.confidence)
            by.append(body.tracker)
            uncertainty.append(body.uncertainty_m)
        on_frame(done)
    n, j = len(times), len(names)
    return RecordedTrack(
        np.array(times),
        names,
        np.array(joints).reshape(n, j, 3),
        np.array(quats).reshape(n, j, 4),
        np.array(confidence).reshape(n, j),
        np.array(by, dtype=np.str_),
        np.array(uncertainty).reshape(n, j),
        unrecognised,
    )


def why_missing(track: RecordedTrack, count: int) -> str:
    """In a line for people, why some of `count` frames have nobody though somebody moves in them; empty: it is not so."""
    if not track.unrecognised:
        return ""
    reason = LostReason.UNRECOGNISED
    return f"in {track.unrecognised} of {count} frames {reason.what} -- {reason.fix}"


def check_writable(path: Path) -> None:
    """Before a long run, that its result can be kept. Raises CannotCreateError."""
    try:
        descriptor, name = tempfile.mkstemp(dir=path.absolute().parent, prefix=f".{path.name}.")
    except OSError as error:
        raise CannotCreateError(
            f"cannot be written ({error.strerror})", str(path), "choose another place with --out"
        ) from None
    os.close(descriptor)
    Path(name).unlink()


def write_track(path: Path, track: RecordedTrack) -> None:
    """Write the npz that score_track.py reads, whole or not at all. Raises CannotCreateError.

    The same track gives the same bytes.
    """
    check_writable(path)
    try:
        # through an open file, for numpy appends .npz to a name that does not end so
        with whole_file(path) as partial, partial.open("wb") as file:
            np.savez_compressed(
                file,
                schema=np.array(SCHEMA),
                times=track.times_s,
                joint_names=np.array(track.joint_names),
                joints=track.joints_m,
                global_quats=track.global_xyzw,
                confidence=track.confidence,
                tracker=track.tracker,
                uncertainty=track.uncertainty_m,
            )
    except OSError as error:
        raise CannotCreateError(
            f"cannot be written ({error.strerror})", str(path), "make room or choose another place"
        ) from None
