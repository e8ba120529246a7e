"""Write what this mocapd keeps into a folder: `python -m tests.museum.make_exhibit FOLDER`; due when a format changes."""

import sys
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from mocapd.body.skeleton import standard_skeleton
from mocapd.calibrate.bump.landmarks import find_landmarks
from mocapd.calibrate.extrinsics.rig_writing import write_rig
from mocapd.service.room_memory import RoomMemory
from mocapd.session.offline import RecordedTrack, write_track
from mocapd.types import Bytes
from mocapd.web.stored_key import stored_key
from mocapd.wizard.intrinsics.saved_intrinsics import store_intrinsics
from mocapd.wizard.saving import save_draft
from mocapd.wizard.setup_keeper import FILE_NAME, UnfinishedSetup, write_draft
from mocapd.wizard.step_names import StepName
from tests.outputs.recorded import frames, record
from tests.wizard.drafts import full_draft

WHEN = datetime(2026, 11, 23, 12, 0, tzinfo=UTC)
PASSWORD = "hunter2"
URL = f"rtsp://admin:{PASSWORD}@10.0.0.7/live"  # of the second camera


def make_exhibit(folder: Path) -> None:
    """Every kind of file that outlives a process, of a setup that is done and of a person who moves."""
    state = folder / "state"
    draft = full_draft()
    draft = replace(draft, cameras=(draft.cameras[0], replace(draft.cameras[1], source=URL)))
    save_draft(draft, state)
    store_intrinsics(draft, state, WHEN)
    done = frozenset({StepName.CAMERAS, StepName.LENS})
    write_draft(state / FILE_NAME, UnfinishedSetup(WHEN, done, draft))
    for name in ("frames.key", "metrics.key"):
        stored_key(state / name)
    assert draft.rig is not None
    seen = {one.name: [find_landmarks(patches(), one)] for one in draft.rig.cameras}
    RoomMemory(state).write({one.name: one for one in draft.rig.cameras}, seen)
    write_rig(folder / "rig.json", draft.rig)
    record(folder / "packed.mcap", frames(0.5))
    record(folder / "exact.mcap", frames(0.1), exact=True, foxglove_hz=0.0)
    write_track(folder / "track.npz", track())


def patches() -> Bytes:
    """A room of random grey patches, of the size of the cameras' pictures."""
    grey = np.random.default_rng(1).integers(0, 255, (6, 8, 3), np.uint8)
    return np.ascontiguousarray(grey.repeat(8, axis=0).repeat(8, axis=1))


def track() -> RecordedTrack:
    """Five frames, in which all joints rise by a centimetre each time."""
    names = standard_skeleton(1.75).names
    shape = 5, len(names)
    up_m = 0.01 * np.arange(5)[:, None, None]
    return RecordedTrack(
        np.arange(5) / 30.0,
        names,
        np.zeros((*shape, 3)) + up_m,
        np.tile([0.0, 0.0, 0.0, 1.0], (*shape, 1)),
        np.full(shape, 0.5),
        np.array(["shirt"] * 5),
        np.full(shape, 0.02),
    )


if __name__ == "__main__":
    make_exhibit(Path(sys.argv[1]))
