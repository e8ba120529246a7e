"""Facts of the calibration that a daemon of this configuration would use."""

import time
from datetime import UTC
from pathlib import Path

from mocapd.calibration.calibration_file import FILE_NAME, LoadedCalibration, find_calibration
from mocapd.config.sections import Config
from mocapd.doctor.facts import CalibrationFacts
from mocapd.errors import MocapdError, Problem
from mocapd.geometry.rig_file import load_rig


def calibration_facts(config: Config) -> tuple[CalibrationFacts, LoadedCalibration | None]:
    """The facts, and the calibration if one is saved and readable."""
    place = config.rig if config.rig is not None else config.state_dir / FILE_NAME
    try:
        saved = find_calibration(config.rig, config.state_dir, config.sources)
        if saved is None and config.rig is not None:
            return _of_rig_file(config.rig), None
    except MocapdError as error:
        return CalibrationFacts(place, Problem.of(error)), None
    if saved is None:
        return CalibrationFacts(None), None
    made, room = saved.tables.made.when, saved.tables.room
    assert room is not None  # reading refuses a calibration without extrinsics
    when = made if made.tzinfo else made.replace(tzinfo=UTC)
    facts = CalibrationFacts(
        saved.path,
        age_s=time.time() - when.timestamp(),
        rms_px=room.rms_px,
        play_area_cm=room.play_area_cm,
        cameras=len(saved.tables.camera),
    )
    return facts, saved


def _of_rig_file(path: Path) -> CalibrationFacts:
    """Facts of a rig in the capture format; its age is the file's. Raises MocapdError."""
    rig = load_rig(path)
    return CalibrationFacts(
        path, age_s=time.time() - path.stat().st_mtime, cameras=len(rig.cameras)
    )
