"""What the tests of every format export: the moving asymmetric person, bones that change a little among it."""

import tempfile
from dataclasses import fields
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mocapd.app.recordings.exporting import motion_of
from mocapd.exports.formats import write_export
from mocapd.exports.sampled_motion import SampledMotion
from mocapd.outputs.mcap.recording_reader import RecordingReader
from mocapd.types import Floats
from tests.outputs.recorded import frames, record

SECONDS = 1.5
MM = 1e-3


@cache
def recorded_motion() -> SampledMotion:
    """By way of a recording, once for all; its arrays cannot be written to."""
    with tempfile.TemporaryDirectory() as folder:
        recording = record(Path(folder) / "a.mcap", frames(SECONDS))
        motion = motion_of(RecordingReader(recording), 0, None).motion
    for one in fields(motion):
        value = getattr(motion, one.name)
        if isinstance(value, np.ndarray):
            value.flags.writeable = False
    return motion


def exported(folder: Path, name: str) -> tuple[SampledMotion, Path]:
    """The motion and its file in this format."""
    motion = recorded_motion()
    path = folder / f"a.{name}"
    write_export(motion, name, path)
    return motion, path


def by_ezc3d(path: Path) -> Any:
    """A C3D file as that library reads it; skips the test on machines that it has no wheel for."""
    return pytest.importorskip("ezc3d").c3d(str(path))


def check_places(found_m: Floats, motion: SampledMotion) -> None:
    """That joints (F,J,3) [m] are where they were recorded, to a millimetre, and that the pose is a moving and
    asymmetric one, so that a mirrored or turned file cannot pass."""
    assert found_m.shape == motion.joints_m.shape
    assert np.linalg.norm(found_m - motion.joints_m, axis=2).max() < MM
    names = motion.skeleton.names
    left, right = (motion.joints_m[:, names.index(name)] for name in ("leftHand", "rightHand"))
    assert (left[:, 1] > right[:, 1] + 0.3).all()
    assert motion.joints_m[-1, 0, 0] > motion.joints_m[0, 0, 0] + 0.3
