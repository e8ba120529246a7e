"""From the rig to the calibration message."""

from mocapd.outputs.messages import CalibratedCamera, CalibrationInfo
from mocapd.types import Rig


def calibration_info(rig: Rig, *, instance: str, source: str) -> CalibrationInfo:
    """The rig as sent; `source` is the file it was read from."""
    return CalibrationInfo(
        instance,
        source,
        tuple(
            CalibratedCamera(
                camera.name,
                camera.size_px,
                tuple(camera.K.ravel().tolist()),
                tuple(camera.dist.ravel().tolist()),
                tuple(camera.R.ravel().tolist()),
                tuple(camera.t_m.ravel().tolist()),
            )
            for camera in rig.cameras
        ),
    )
