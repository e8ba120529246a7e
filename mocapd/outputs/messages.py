"""What a late joiner may ask for: health, camera status and calibration, as sent on the wire."""

from typing import Annotated

import msgspec
from msgspec import Meta

HEALTH = "mocapd.Health.v1"
CAMERA_STATUS = "mocapd.CameraStatus.v1"
CALIBRATION = "mocapd.Calibration.v1"


class OutputHealth(msgspec.Struct, frozen=True):
    """One output as its sink sees it."""

    name: Annotated[str, Meta(description="name of the output: `zenoh`, `osc`, ...")]
    sent: Annotated[int, Meta(description="frames sent since the start")]
    refused: Annotated[int, Meta(description="frames that nobody took or the system refused")]
    listeners: Annotated[int, Meta(description="how many listen; -1: the protocol cannot tell")]
    detail: Annotated[str, Meta(description="one line for people")]


class Health(msgspec.Struct, frozen=True):
    """How the daemon fares, about once a second."""

    instance: Annotated[str, Meta(description="name of the sending daemon, as in the key")]
    version: Annotated[str, Meta(description="version of mocapd")]
    pid: Annotated[int, Meta(description="process id of the daemon")]
    started_unix_ns: Annotated[int, Meta(description="start of the daemon, Unix time [ns]")]
    now_unix_ns: Annotated[int, Meta(description="when this was said, Unix time [ns]")]
    tracker: Annotated[str, Meta(description="the tracker in use")]
    tracking: Annotated[str, Meta(description="`live`, `coasting` or `lost`")]
    rate_hz: Annotated[float, Meta(description="skeleton frames per second, lately [Hz]")]
    latency_median_ms: Annotated[float, Meta(description="capture to publish, median [ms]")]
    latency_p95_ms: Annotated[float, Meta(description="capture to publish, 95th percentile [ms]")]
    frame_sets: Annotated[int, Meta(description="frame sets tracked since the start")]
    dropped: Annotated[int, Meta(description="frame sets displaced by newer ones since the start")]
    outputs: Annotated[tuple[OutputHealth, ...], Meta(description="every open output")] = ()
    schema: Annotated[str, Meta(description=f"always `{HEALTH}`")] = HEALTH


class CameraStatus(msgspec.Struct, frozen=True):
    """One camera; sent when its state changes and about once a second."""

    instance: Annotated[str, Meta(description="name of the sending daemon, as in the key")]
    camera: Annotated[str, Meta(description="name of the camera in the rig")]
    state: Annotated[
        str, Meta(description="`live`, `starting`, `lost` (being reopened) or `ended`")
    ]
    detail: Annotated[str, Meta(description="one line for people: why it is not live")]
    source: Annotated[str, Meta(description="device node, path or URL it is read from")]
    identity: Annotated[
        str, Meta(description="USB port path, vid:pid and serial; empty: no webcam")
    ]
    size_px: Annotated[tuple[int, int], Meta(description="width, height of its pictures [px]")]
    rate_hz: Annotated[float, Meta(description="pictures per second, lately [Hz]")]
    frames: Annotated[int, Meta(description="pictures taken since the start")]
    lost_frames: Annotated[int, Meta(description="pictures that the source lost or tore")]
    reopened: Annotated[int, Meta(description="how often it had to be opened again")]
    mounting: Annotated[
        str,
        Meta(
            description="`steady`; `bumped`: turned since the start, calibrate the room again; or `unknown`"
        ),
    ] = "unknown"
    schema: Annotated[str, Meta(description=f"always `{CAMERA_STATUS}`")] = CAMERA_STATUS


class CalibratedCamera(msgspec.Struct, frozen=True):
    """A lens and where it stands: x_camera = R x_world + t, OpenCV axes."""

    name: Annotated[str, Meta(description="name of the camera in the rig")]
    size_px: Annotated[tuple[int, int], Meta(description="width, height of the calibration [px]")]
    K: Annotated[tuple[float, ...], Meta(description="camera matrix, 9 numbers by rows [px]")]
    dist: Annotated[tuple[float, ...], Meta(description="k1 k2 p1 p2 k3")]
    R: Annotated[tuple[float, ...], Meta(description="camera from world, 9 numbers by rows")]
    t_m: Annotated[tuple[float, ...], Meta(description="camera from world, 3 numbers [m]")]


class CalibrationInfo(msgspec.Struct, frozen=True):
    """The rig that the daemon tracks with."""

    instance: Annotated[str, Meta(description="name of the sending daemon, as in the key")]
    source: Annotated[str, Meta(description="the file it was read from")]
    cameras: Annotated[tuple[CalibratedCamera, ...], Meta(description="in the order of the rig")]
    schema: Annotated[str, Meta(description=f"always `{CALIBRATION}`")] = CALIBRATION


Message = Health | CameraStatus | CalibrationInfo
