"""What a capture folder knows."""

from mocapd.calibration.record import Calibration, ShirtColours, Wearer
from mocapd.calibration.shirt_pictures import read_model
from mocapd.capture.capture_folder import CaptureFolder
from mocapd.shirt.colour.strokes import read_labelled


def from_capture(folder: CaptureFolder) -> Calibration:
    """Its rig, its subject, and its pictures of the shirt. Raises InputError or ConfigError."""
    scribbles = {c.name: read_labelled(c.scribble) for c in folder.cameras if c.scribble}
    return Calibration(
        folder.rig, Wearer(folder.stature_m), ShirtColours(read_model(folder.model), scribbles)
    )
