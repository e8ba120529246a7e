"""Facts of the machine's webcams and of the configured cameras."""

from collections.abc import Sequence

from mocapd.boundary.urls import without_password
from mocapd.calibration.calibration_file import LoadedCalibration
from mocapd.capture.webcam.usb_bandwidth import CrowdedBus, crowded_buses
from mocapd.capture.webcam.v4l2 import WebcamSettings
from mocapd.capture.webcam.webcam_listing import CameraInfo, list_cameras
from mocapd.config.sections import Config
from mocapd.doctor.facts import CameraFacts
from mocapd.wizard.cameras.camera_nodes import mode_of, node_of
from mocapd.wizard.draft import DraftCamera


def camera_facts(config: Config, saved: LoadedCalibration | None) -> CameraFacts:
    """The facts; queries each node, streams from none."""
    nodes, asked = list_cameras(), wanted_cameras(config, saved)
    return CameraFacts(nodes, asked, _overloaded_buses(asked, nodes))


def wanted_cameras(config: Config, saved: LoadedCalibration | None) -> tuple[DraftCamera, ...]:
    """Cameras of the configuration, else of the calibration; addresses without passwords."""
    calibrated = {camera.id: camera for camera in saved.tables.camera} if saved else {}
    usual = WebcamSettings()
    cameras = []
    for camera in config.camera or calibrated.values():
        mode = calibrated.get(camera.id, usual)
        source, fps_hz = without_password(camera.source), camera.fps_hz or mode.fps_hz
        cameras.append(DraftCamera(camera.id, source, mode.size_px, fps_hz))
    return tuple(cameras)


def _overloaded_buses(
    cameras: Sequence[DraftCamera], nodes: Sequence[CameraInfo]
) -> tuple[CrowdedBus, ...]:
    on_usb = {}
    for camera in cameras:
        node = node_of(camera, nodes)
        if node is not None and node.identity is not None and node.formats:
            on_usb[camera.id] = (node.identity.port_path, mode_of(camera, node))
    return crowded_buses(on_usb)
