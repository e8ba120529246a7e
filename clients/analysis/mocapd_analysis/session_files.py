"""Sessions from files: a recording of `mocapd record`, or a track of `mocapd track`."""

import logging
import struct
import zipfile
import zlib
from dataclasses import replace
from pathlib import Path

import numpy as np

from mocapd.body.bones import PARENT_OF
from mocapd.boundary.files import is_file
from mocapd.errors import InputError
from mocapd.outputs.frame_times import frame_times_ns
from mocapd.outputs.mcap.recording_reader import RecordingReader
from mocapd.outputs.wire import SkeletonFrame
from mocapd.types import Floats, Ints
from mocapd_analysis.joint_angles import angles_of
from mocapd_analysis.session import Session

MOST_BYTES = 2 << 30  # of a track when unpacked: two days of frames
MOST_FRAMES = 2_000_000
_TRACK = "mocapd.Track.v1"  # what says none is of it too
_FIELDS = ("times", "joint_names", "joints", "confidence")
_FIX = "give a file of `mocapd record` (.mcap) or `mocapd track` (.npz)"
# What numpy, zipfile and zlib raise for a file that is cut short, damaged, encrypted or foreign.
_BAD_TRACK = (
    OSError, ValueError, TypeError, EOFError, KeyError, NotImplementedError, RuntimeError,
    SyntaxError, MemoryError, struct.error, zlib.error, zipfile.BadZipFile,
)  # fmt: skip
FARTHEST_M = 1000.0  # of a joint from the origin; beyond is no place in a room


def read_session(path: Path, person: int = 0) -> Session:
    """Raises InputError naming the file for what is missing, foreign, damaged, or without a person."""
    if not is_file(path):
        raise InputError("no such file", str(path), _FIX)
    try:
        with path.open("rb") as file:
            beginning = file.read(4)
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", str(path), _FIX) from None
    # by what it is, not by what it is called
    return _read_track(path) if beginning[:2] == b"PK" else _read_recording(path, person)


def checked_session(
    name: str,
    joint_names: tuple[str, ...],
    times_s: Floats,
    joints_m: Floats,
    confidence: Floats,
    notes: tuple[str, ...] = (),
) -> Session:
    """A session of arrays from outside: frames that are not finite or go back in time are left out, and noted.

    Raises InputError without a place where nothing is left.
    """
    known = [i for i, joint in enumerate(joint_names) if joint == "hips" or joint in PARENT_OF]
    if "hips" not in joint_names or len(set(joint_names)) != len(joint_names):
        raise InputError("holds no body: its joints are not those of VRM 1.0", fix=_FIX)
    names = tuple(joint_names[i] for i in known)
    joints_m, confidence = joints_m[:, known], confidence[:, known]
    sane = np.isfinite(times_s) & (np.abs(joints_m) < FARTHEST_M).all(axis=(1, 2))  # no for NaN
    sane &= np.isfinite(confidence).all(axis=1)
    notes += _counted(len(sane) - int(sane.sum()), "not finite, or out of any room")
    times_s, joints_m, confidence = times_s[sane], joints_m[sane], confidence[sane]
    newest = np.maximum.accumulate(times_s) if len(times_s) else times_s
    forward = np.concatenate([[True], times_s[1:] > newest[:-1]])[: len(times_s)]
    notes += _counted(len(forward) - int(forward.sum()), "not later than the frame before")
    if not forward.any():
        raise InputError("holds no frame with a person", fix="record again with somebody in view")
    times_s, joints_m = times_s[forward], joints_m[forward]
    confidence = np.clip(confidence[forward], 0.0, 1.0)
    session = Session(
        name, names, _parents(names), times_s - times_s[0], joints_m, confidence, notes
    )
    return _without_held_legs(session)


def _without_held_legs(session: Session) -> Session:
    """A tracker of the upper body carries the legs along, straight: they are drawn, and no figure is of them."""
    held = [name for name in session.joint_names if name.endswith(("LowerLeg", "Foot", "Toes"))]
    knees = [
        angle
        for name, angle in angles_of(session).items()
        if name.endswith("Knee") and np.isfinite(angle).any()
    ]
    if len(session.times_s) < 10 or not knees or any(np.nanstd(knee) > 0.1 for knee in knees):
        return session
    confidence = session.confidence.copy()
    confidence[:, [session.joint(name) for name in held]] = 0.0
    note = "the knees never bend: the tracker carries the legs along, and no figure is of them"
    return replace(session, confidence=confidence, notes=(*session.notes, note))


def _counted(count: int, what: str) -> tuple[str, ...]:
    if count == 0:
        return ()
    return (f"{count} frame{'s are' if count > 1 else ' is'} {what}, and left out",)


def _parents(names: tuple[str, ...]) -> Ints:
    """Of each joint the place of the nearest joint above it that is there; -1 at the hips."""
    found = []
    for name in names:
        above = PARENT_OF.get(name, "")
        while above and above not in names:
            above = PARENT_OF.get(above, "")
        found.append(names.index(above) if above else -1)
    return np.array(found, dtype=np.int64)


class _Said(logging.Handler):
    """What the reader of recordings has to say of a file, kept for the report."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.lines: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.lines.append(record.getMessage())


def _read_recording(path: Path, person: int) -> Session:
    said, log = _Said(), logging.getLogger("mocapd.outputs.mcap.recording_reader")
    log.addHandler(said)
    try:
        frames = [
            item
            for item in RecordingReader(path).everything()
            if isinstance(item, SkeletonFrame) and item.person == person
        ]
    finally:
        log.removeHandler(said)
    notes = tuple(line.removeprefix(f"{path}: ") for line in said.lines)
    return _of_frames(path, frames, person, notes)


def _of_frames(
    path: Path, frames: list[SkeletonFrame], person: int, notes: tuple[str, ...]
) -> Session:
    tracked = [frame for frame in frames if frame.joints]
    if not tracked:
        raise InputError(
            f"person {person} is tracked nowhere in it",
            str(path),
            "record again with somebody in view",
        )
    names = tuple(tracked[0].joints)
    same = [frame for frame in tracked if tuple(frame.joints) == names]
    lost = len(frames) - len(tracked)
    if lost:
        notes += (f"{lost} of {len(frames)} frames are without a person",)
    notes += _counted(len(tracked) - len(same), "of another skeleton")
    joints = [list(frame.joints.values()) for frame in same]
    start_ns = same[0].capture_unix_ns
    try:
        session = checked_session(
            path.stem,
            names,
            (np.array(frame_times_ns(same)) - start_ns) * 1e-9,
            np.array([[one.p for one in each] for each in joints], dtype=float),
            np.array([[one.c for one in each] for each in joints], dtype=float),
            notes,
        )
    except InputError as error:
        raise InputError(error.what, str(path), error.fix) from None
    return replace(session, recorded_unix_s=start_ns * 1e-9)


def _read_track(path: Path) -> Session:
    try:
        with zipfile.ZipFile(path) as archive:
            if sum(one.file_size for one in archive.infolist()) > MOST_BYTES:
                raise InputError("is far larger than any track when unpacked", str(path), _FIX)
        with np.load(path, allow_pickle=False) as data:
            missing = [field for field in _FIELDS if field not in data.files]
            if missing:
                raise InputError(f"is no track: it lacks {', '.join(missing)}", str(path), _FIX)
            schema = str(data["schema"]) if "schema" in data.files else _TRACK
            if schema != _TRACK:
                raise InputError(
                    f"is a track of the schema {schema[:80]!r}, not {_TRACK}", str(path), _FIX
                )
            names = tuple(str(name) for name in np.atleast_1d(data["joint_names"]))
            times_s, joints_m, confidence = (
                np.asarray(data[field], dtype=float) for field in ("times", "joints", "confidence")
            )
    except _BAD_TRACK as error:
        raise InputError(f"is damaged or no track ({error})", str(path), _FIX) from None
    frames = len(times_s) if times_s.ndim == 1 else -1
    if joints_m.shape != (frames, len(names), 3) or confidence.shape != (frames, len(names)):
        raise InputError("is no track: its arrays are not of one length", str(path), _FIX)
    if frames > MOST_FRAMES:
        raise InputError(f"has {frames} frames, which are too many", str(path), _FIX)
    try:
        return checked_session(path.stem, names, times_s, joints_m, confidence)
    except InputError as error:
        raise InputError(error.what, str(path), error.fix) from None
