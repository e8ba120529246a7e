"""The machine's webcams, and those that are wanted."""

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
    """Opens each node for questions, streams from none."""
    nodes, asked = list_cameras(), wanted_cameras(config, saved)
    return CameraFacts(nodes, asked, _crowded(asked, nodes))


def wanted_cameras(config: Config, saved: LoadedCalibration | None) -> tuple[DraftCamera, ...]:
    """Those of the configuration, else of the calibration; addresses without their passwords."""
    sizes = {one.id: one.size_px for one in saved.tables.camera} if saved else {}
    found = [(one.id, one.source, one.fps_hz) for one in config.camera]
    if not found and saved is not None:
        found = [(one.id, one.source, one.fps_hz) for one in saved.tables.camera]
    usual_px = WebcamSettings().size_px
    return tuple(
        DraftCamera(name, without_password(source), sizes.get(name, usual_px), fps_hz)
        for name, source, fps_hz in found
    )


def _crowded(cameras: Sequence[DraftCamera], nodes: Sequence[CameraInfo]) -> tuple[CrowdedBus, ...]:
    on_usb = {}
    for camera in cameras:
        node = node_of(camera, nodes)
        if node is not None and node.identity is not None and node.formats:
            on_usb[camera.id] = (node.identity.port_path, mode_of(camera, node))
    return crowded_buses(on_usb)
