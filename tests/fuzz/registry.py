"""Every parser and its fuzzer: the table of the attack of 2026-11-22, and what was found beside it."""

from tests.fuzz import calibrations
from tests.fuzz.row import Row

ROWS = (
    Row("rig", 6023, calibrations.rigs),
    Row("calibration", 5057, calibrations.calibrations),
    Row("calibration-pictures", 6000, calibrations.pictures),
    Row("lenses", 6028, calibrations.lenses),
)
