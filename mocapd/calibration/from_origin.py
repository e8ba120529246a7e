"""The calibration record of a recording or a scenario."""

from mocapd.calibration.calibration_record import Calibration, ShirtColours, Wearer
from mocapd.capture.capture_folder import CaptureFolder
from mocapd.capture.kinds.folder_kind import FolderOrigin
from mocapd.capture.origin import Origin


def from_origin(origin: Origin) -> Calibration:
    """Its rig, its subject, and its pictures of the shirt. Raises InputError or ConfigError."""
    return Calibration(
        origin.rig, Wearer(origin.stature_m), ShirtColours(origin.model(), origin.white_balance())
    )


def from_capture(folder: CaptureFolder) -> Calibration:
    """The same of a capture folder."""
    return from_origin(FolderOrigin(folder))
