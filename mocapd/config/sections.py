"""The sections of the configuration: the parts' own parameters, composed."""

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal

import platformdirs
from msgspec import Meta

from mocapd.capture.webcam.controls import Controls
from mocapd.config import node_params, web_params
from mocapd.config.config_keys import SectionTable
from mocapd.errors import ConfigError
from mocapd.outputs.output_table import OutputSection, default_sections, output_sections
from mocapd.outputs.prediction.prediction_params import PredictionParams
from mocapd.pipeline.smoothing import PRESETS
from mocapd.trackers.registry import entry
from mocapd.tracking.tracking_state import COAST_S, TrackingStateParams

USUAL_RATE_HZ = 30.0  # of a webcam without a setup


def default_cache_dir() -> Path:
    """$CACHE_DIRECTORY under systemd, else the XDG folder."""
    given = os.environ.get("CACHE_DIRECTORY", "").partition(":")[0]
    return Path(given) if given else platformdirs.user_cache_path("mocapd")


def default_state_dir() -> Path:
    """Folder of calibrations: $STATE_DIRECTORY under systemd, else the XDG folder."""
    given = os.environ.get("STATE_DIRECTORY", "").partition(":")[0]
    return Path(given) if given else platformdirs.user_state_path("mocapd")


@dataclass(frozen=True, slots=True)
class ControlsSection(Controls):
    """Controls of a webcam; a missing value is as the setup locked it, else the camera's own.

    auto_exposure, auto_wb, autofocus: true: the camera sets it automatically
    exposure: in the camera's unit, mostly 100 us
    gain: in the camera's unit
    wb_temperature: [K]
    focus: in the camera's unit
    dynamic_framerate: whether the camera may lower its rate in dim light
    power_line_hz: mains frequency of the lamps, whose flicker the camera filters: 50, 60, or 0 for none
    """


@dataclass(frozen=True, slots=True)
class CameraSection:
    """One camera.

    id: its name in the rig file
    source: the address that `mocapd cameras` or `camera-node` prints, a file, FOLDER#camN, a URL, or sim:NAME#camN; the error
      for an invalid one lists all forms
    fps_hz: rate requested from a webcam [Hz]; unset: the rate it was calibrated at, else 30
    wait_s: how long to wait for a picture of this camera after the first picture of the same instant [s], in place of
      bundler.wait_s; for network cameras
    white_balance: a picture of the shirt in the light of this room, with its `_strokes.png` in the same folder
    """

    id: Annotated[str, Meta(min_length=1)]
    source: Annotated[str, Meta(min_length=1)]
    fps_hz: Annotated[float, Meta(ge=0.1, le=1000)] | None = None
    wait_s: Annotated[float, Meta(ge=0, le=1)] | None = None
    white_balance: Path | None = None
    controls: ControlsSection = field(default_factory=ControlsSection)

    @property
    def rate_hz(self) -> float:
        return USUAL_RATE_HZ if self.fps_hz is None else self.fps_hz


@dataclass(frozen=True, slots=True)
class BundlerSection:
    """How long the pictures of one moment wait for each other.

    wait_s: how long to wait for a picture after the first one of the same instant [s]; unset: the usual delay of that camera
      plus half a frame
    """

    wait_s: Annotated[float, Meta(ge=0, le=1)] | None = None


@dataclass(frozen=True, slots=True)
class TrackerSection:
    """The tracker, and its assumptions about the wearer.

    name: auto uses all available cues; shirt or markerless, that cue alone; canned (moves by itself); wang2011, hecht2009,
      rao_hodges (as published)
    stature_m: the wearer's height without shoes [m]
    coast_s: how long a pose is predicted after the last evidence [s]
    stuck_s: if one step of the tracker takes longer, the process ends with exit code 70 [s]
    """

    name: str = "auto"
    stature_m: Annotated[float, Meta(ge=0.5, le=2.6)] = 1.75
    coast_s: Annotated[float, Meta(ge=0, le=60)] = COAST_S
    stuck_s: Annotated[float, Meta(ge=1, le=3600)] = 30.0

    def __post_init__(self) -> None:
        entry(self.name)

    @property
    def tracking(self) -> TrackingStateParams:
        """Parameters of the loss of a person."""
        return TrackingStateParams(coast_s=self.coast_s)


@dataclass(frozen=True, slots=True)
class ShirtSection:
    """The shirt's colours without a setup.

    colour_model: folder of images of the shirt with strokes
    """

    colour_model: Path | None = None


@dataclass(frozen=True, slots=True)
class SmoothingSection:
    """How much the pose is smoothed after tracking.

    preset: off, responsive, balanced or smooth; the smoother, the later
    """

    preset: str = "balanced"

    def __post_init__(self) -> None:
        if self.preset not in PRESETS:
            raise ConfigError(
                f"no preset {self.preset!r}", "smoothing.preset", f"one of: {', '.join(PRESETS)}"
            )


@dataclass(frozen=True, slots=True)
class WebSection(web_params.Params):
    """See web_params.Params.

    enabled: serve the page with the setup and the live view, to this machine only
    """


@dataclass(frozen=True, slots=True)
class Config:
    """Everything a user may set.

    instance: this daemon's name in the Zenoh keys; empty: the machine's name
    rig: the calibration of the cameras: a rig file, a calibration.toml or a folder with one; without it that of state_dir
    log_level: how much is logged on stderr
    cache_dir: folder of reproducible files (compiled code, pose database)
    state_dir: folder of the calibration that `mocapd calibrate` saves
    camera: the cameras, one [[camera]] section each
    outputs: a section for each, [zenoh], [osc], ...
    """

    instance: Annotated[str, Meta(max_length=64)] = ""
    rig: Path | None = None
    log_level: Literal["debug", "info", "warning", "error"] = "info"
    cache_dir: Annotated[
        Path, Meta(extra={"default": "$CACHE_DIRECTORY or $XDG_CACHE_HOME/mocapd"})
    ] = field(default_factory=default_cache_dir)
    state_dir: Annotated[
        Path, Meta(extra={"default": "$STATE_DIRECTORY or $XDG_STATE_HOME/mocapd"})
    ] = field(default_factory=default_state_dir)
    camera: tuple[CameraSection, ...] = ()
    bundler: BundlerSection = field(default_factory=BundlerSection)
    tracker: TrackerSection = field(default_factory=TrackerSection)
    shirt: ShirtSection = field(default_factory=ShirtSection)
    smoothing: SmoothingSection = field(default_factory=SmoothingSection)
    outputs: Annotated[Mapping[str, OutputSection], SectionTable(output_sections)] = field(
        default_factory=default_sections
    )
    prediction: PredictionParams = field(default_factory=PredictionParams)
    web: WebSection = field(default_factory=WebSection)
    node: node_params.Params = field(default_factory=node_params.Params)

    @property
    def sources(self) -> dict[str, str]:
        """The address of each camera, by id."""
        return {camera.id: camera.source for camera in self.camera}
