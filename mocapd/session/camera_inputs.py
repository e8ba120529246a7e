"""Makes sources of the configured cameras, in the order of the rig."""

from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from types import MappingProxyType

from mocapd.boundary.image_decoding import REDUCTIONS
from mocapd.boundary.urls import without_password
from mocapd.capture.base import Source
from mocapd.capture.kinds.source_kinds import (
    identities_of,
    identity_of,
    is_settable,
    open_source,
)
from mocapd.capture.origin import Origin
from mocapd.capture.pace import Pace
from mocapd.capture.source_request import SourceRequest
from mocapd.capture.webcam.v4l2 import WebcamSettings
from mocapd.config.sections import CameraSection, Config
from mocapd.errors import ConfigError
from mocapd.fit.fit_params import FitParams
from mocapd.fit.work_size import image_scales
from mocapd.pipeline.bundler import BundlerParams
from mocapd.trackers.registry import entry
from mocapd.types import Rig


@dataclass(frozen=True, slots=True)
class CameraInput:
    """A camera of the daemon.

    address: of its source; may hold a password, so it is never shown, sent or logged: use `spec`. size_px: (width,
    height) of its pictures, (0, 0) if unknown; expected_hz: a lower rate is logged as a warning.
    """

    source: Source
    address: str = field(repr=False)
    size_px: tuple[int, int] = (0, 0)
    expected_hz: float | None = None

    @property
    def spec(self) -> str:
        """The address without its password, for users."""
        return without_password(self.address)

    @property
    def identity(self) -> str:
        """PORT:VID:PID:SERIAL of a webcam, as it is configured; empty for what has none."""
        return self.address.partition(":")[2] if identity_of(self.address) is not None else ""


def camera_inputs(
    cameras: Sequence[CameraSection],
    rig: Rig | None,
    origin: Origin | None = None,
    usual_px: tuple[int, int] = WebcamSettings().size_px,
    reduced_by: Mapping[str, int] = MappingProxyType({}),
) -> tuple[CameraInput, ...]:
    """Sources of these cameras, checked but not opened. origin: of all cameras; usual_px: size of webcams outside the
    rig; reduced_by: see SourceRequest, by camera. Raises ConfigError or InputError."""
    cameras = in_rig_order(cameras, rig)
    sizes = {camera.name: camera.size_px for camera in rig.cameras} if rig else {}
    identities = identities_of((camera.id, camera.source) for camera in cameras)
    pace = Pace(live=True)  # recordings start together and keep their own time
    inputs = []
    for camera in cameras:
        size_px = sizes.get(camera.id)
        settings = WebcamSettings(
            size_px=size_px or usual_px,
            fps_hz=camera.rate_hz,
            controls=camera.controls,
        )
        others = tuple(identity for name, identity in identities.items() if name != camera.id)
        request = SourceRequest(
            camera.id, size_px, settings, others, pace, reduced_by.get(camera.id, 1)
        )
        open_one = open_source if origin is None else origin.source
        source = open_one(camera.source, request)
        rate_hz = camera.rate_hz if origin is None else origin.fps_hz
        expected_hz = None if source.recorded else rate_hz
        inputs.append(CameraInput(source, camera.source, size_px or (0, 0), expected_hz))
    return tuple(inputs)


def reductions(tracker: str, rig: Rig | None) -> Mapping[str, int]:
    """How many times smaller each camera's JPEG is decoded for this tracker; see SourceRequest."""
    if rig is None or entry(tracker).whole_pictures:
        return {}
    scales = image_scales(rig.cameras, FitParams().work_width_px)
    return {
        camera.name: max(by for by in REDUCTIONS if scale % by == 0)
        for camera, scale in zip(rig.cameras, scales, strict=True)
    }


def bundler_params(config: Config) -> BundlerParams:
    """The bundler's waiting times."""
    every_s = config.bundler.wait_s
    waits_s = {c.id: every_s if c.wait_s is None else c.wait_s for c in config.camera}
    return BundlerParams(camera_waits_s={k: s for k, s in waits_s.items() if s is not None})


def picture_size(camera: CameraSection) -> tuple[int, int]:
    """Picture size (width, height) [px]: of a webcam the requested one, of other sources that of their first picture.
    Raises MocapdError without a picture."""
    source = open_source(camera.source, SourceRequest(camera.id))
    if is_settable(camera.source):
        return WebcamSettings().size_px
    with closing(source):
        source.open()
        return source.read().size_px


def in_rig_order(cameras: Sequence[CameraSection], rig: Rig | None) -> tuple[CameraSection, ...]:
    """The cameras in the rig's order. Raises ConfigError for one outside the rig."""
    if rig is None:
        return tuple(cameras)
    for camera in cameras:
        if camera.id not in rig.names:
            raise ConfigError(
                f"the rig has no camera {camera.id!r}",
                "camera",
                f"it has {', '.join(rig.names)}: correct the id, or calibrate again",
            )
    return tuple(sorted(cameras, key=lambda camera: rig.names.index(camera.id)))
