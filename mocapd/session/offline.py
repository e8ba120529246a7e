"""Tracks a recorded capture, every frame in order at full speed, and writes the track's file."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mocapd.body.shape import BodyShape, skeleton_of
from mocapd.clock import seconds
from mocapd.errors import ConfigError
from mocapd.output_file import FileKind, OutputFile
from mocapd.tracking.base import LostReason, RoomLearner, Tracker
from mocapd.tracking.tracking_state import lower_confidence
from mocapd.types import Floats, FrameSet

SCHEMA = "mocapd.Track.v1"
# Identified by the archive's first member, as other npz files exist.
_TRACK = FileKind(
    "a track", lambda head: head.startswith(b"PK\x03\x04") and head[30:40] == b"schema.npy"
)
_ROOM_LOOKS = 60  # pictures of each camera to learn a room from, all in memory


@dataclass(frozen=True, slots=True, eq=False)
class RecordedTrack:
    """F frames of J joints; frames without a tracked person are absent.

    times_s (F,): since the capture's start [s]; joints_m (F,J,3) [m, world]; global_xyzw (F,J,4):
    rotations relative to the T-pose; confidence (F,J) 0..1; tracker (F,); uncertainty_m (F,J): as in BodyState,
    inf where it is unknown, and everywhere when omitted; unrecognised: number of frames with motion that is not
    recognised as a person.
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
    """Lets a tracker learn the empty room from a sample of a recording's frame sets. count: their approximate number.
    Raises ConfigError for a tracker that learns no room."""
    if not isinstance(tracker, RoomLearner):
        raise ConfigError(
            f"the tracker {tracker.name!r} learns no room", "--room", "leave it out, or add --tracker markerless"
        )  # fmt: skip
    tracker.learn_room(islice(frames, None, None, max(1, -(-count // _ROOM_LOOKS))))


def track_all(
    tracker: Tracker,
    shape: BodyShape,
    frames: Iterable[FrameSet],
    on_frame: Callable[[int], None],
    off_m: float = 0.0,
) -> RecordedTrack:
    """Steps the tracker through all frame sets. shape: the wearer's; on_frame: called with the number of finished frames;
    off_m: lasting disagreement of the cameras' views [m]."""
    names = skeleton_of(shape).names
    times, joints, quats, confidence, by, uncertainty = [], [], [], [], [], []
    unrecognised = 0
    for done, frame_set in enumerate(frames, start=1):
        track = tracker.step(frame_set, shape)
        body, shape = lower_confidence(track.body, off_m), track.shape
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


def track_file(path: Path, force: bool = False, inputs: Sequence[Path] = ()) -> OutputFile:
    """The output file of a track; see OutputFile."""
    return OutputFile(path, _TRACK, force, inputs)


def why_missing(track: RecordedTrack, count: int) -> str:
    """A line for users: why frames with motion have no person; empty without such frames. count: all frames."""
    if not track.unrecognised:
        return ""
    reason = LostReason.UNRECOGNISED
    return f"in {track.unrecognised} of {count} frames {reason.what} -- {reason.fix}"


def write_track(out: OutputFile | Path, track: RecordedTrack) -> None:
    """Writes the npz that score_track.py reads, atomically. Raises CannotCreateError.

    The same track gives the same bytes.
    """
    out = track_file(out) if isinstance(out, Path) else out
    # through an open file, for numpy appends .npz to a name that does not end so
    with out.writing() as partial, partial.open("wb") as file:
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
