"""What the configuration itself knows."""

from mocapd.calibration.calibration_record import Calibration, ShirtColours
from mocapd.calibration.shirt_pictures import stroked_folder, stroked_image
from mocapd.config.sections import CameraSection, ShirtSection
from mocapd.shirt.colour.model_pictures import read_model
from mocapd.shirt.colour.strokes import read_labelled
from mocapd.types import Rig


def from_configuration(
    shirt: ShirtSection, cameras: tuple[CameraSection, ...], rig: Rig | None
) -> Calibration:
    """The rig that it names, and the pictures of the shirt. Its stature is not known but assumed, where
    nobody else says. Raises InputError or ConfigError."""
    folder = shirt.colour_model
    return Calibration(
        rig,
        shirt=ShirtColours(
            read_model(stroked_folder(folder)) if folder else (),
            {
                c.id: read_labelled(stroked_image(c.white_balance))
                for c in cameras
                if c.white_balance
            },
        ),
    )
