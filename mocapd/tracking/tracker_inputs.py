"""Inputs of a tracker from the calibration: rig, stature and body shape."""

from mocapd.body.shape import BodyShape, mean_shape, measured_shape
from mocapd.calibration.calibration_record import Calibration
from mocapd.errors import ConfigError
from mocapd.types import Rig


def stature_m(calibration: Calibration) -> float:
    """The wearer's stature [m]. Raises ConfigError if the calibration lacks it."""
    if calibration.wearer.stature_m is None:
        raise ConfigError(
            "the wearer's height is not known", "tracker.stature_m", "give it in metres"
        )
    return calibration.wearer.stature_m


def wearer_shape(calibration: Calibration) -> BodyShape:
    """The wearer's measured body shape, or the mean body of this stature. Raises ConfigError without a stature."""
    stature, factors = stature_m(calibration), calibration.wearer.shape_factors
    return mean_shape(stature) if factors is None else measured_shape(stature, factors.copy())


def calibrated_rig(calibration: Calibration) -> Rig:
    """The calibrated cameras. Raises ConfigError without a rig."""
    if calibration.rig is None:
        raise ConfigError(
            "the cameras are not calibrated",
            "rig",
            "calibrate them, or give a rig file (rig = ..., or --rig)",
        )
    return calibration.rig
