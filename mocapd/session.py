"""What one run of the daemon works on: cameras, rig and tracker, from the configuration.

Cameras that are all of one capture folder, or all of one simulated scenario, bring rig, stature and
colours with them; what the configuration gives itself wins.
"""

from dataclasses import dataclass, replace
from pathlib import Path

from mocapd.camera_inputs import CameraInput, camera_inputs
from mocapd.capture.folder import load_folder
from mocapd.config_sections import CameraSection, Config
from mocapd.errors import ConfigError
from mocapd.geometry.rig_file import load_rig
from mocapd.tracker_setup import (
    Progress,
    build_tracker,
    inputs_of_capture,
    inputs_of_config,
)
from mocapd.trackers.base import Tracker
from mocapd.trackers.registry import TrackerInputs
from mocapd.types import Rig

SIM = "sim:"  # the renderer is imported for such cameras only: it takes a second


@dataclass(frozen=True, slots=True, eq=False)
class Session:
    """`rig_source`: the file or scenario that the rig is from, for people."""

    cameras: tuple[CameraInput, ...]
    rig: Rig | None
    rig_source: str
    tracker: Tracker


def cameras_of(capture: str) -> tuple[CameraSection, ...]:
    """Every camera of a capture folder or of `sim:SCENARIO`. Raises InputError or ConfigError."""
    if capture.startswith(SIM):
        from mocapd import simulation

        names = simulation.camera_names(capture)
    else:
        names = load_rig(Path(capture) / "rig.json").names
    return tuple(CameraSection(name, f"{capture}#{name}") for name in names)


def open_session(config: Config, progress: Progress) -> Session:
    """Check and prepare everything; `progress` is told while something long is made for the first
    time. Raises ConfigError, InputError or CannotCreateError."""
    if not config.camera:
        raise ConfigError(
            "no camera is configured",
            "camera",
            "add [[camera]] with id and source (see `mocapd cameras`), or --camera ID=SOURCE",
        )
    origin = _common_origin(config.camera)
    if origin.startswith(SIM):
        return _simulated(config, origin, progress)
    rig, rig_source = (load_rig(config.rig), str(config.rig)) if config.rig else (None, "")
    inputs = inputs_of_config(config.tracker, config.camera, rig)
    if origin:
        folder = load_folder(Path(origin))
        told = inputs_of_capture(folder, config.tracker.stature_m)
        inputs = _merged(inputs, told)
        rig, rig_source = (rig, rig_source) if rig else (folder.rig, str(folder.path / "rig.json"))
    cameras = camera_inputs(config.camera, rig)
    return Session(cameras, rig, rig_source, build_tracker(config.tracker.name, inputs))


def _simulated(config: Config, source: str, progress: Progress) -> Session:
    from mocapd import simulation

    film = simulation.open_film(source, config.cache_dir, progress)
    inputs = _merged(
        inputs_of_config(config.tracker, config.camera, None),
        simulation.inputs_of_simulation(film.setup),
    )
    cameras = simulation.simulated_inputs(config.camera, film)
    tracker = build_tracker(config.tracker.name, inputs)
    return Session(cameras, film.setup.rig, source, tracker)


def _common_origin(cameras: tuple[CameraSection, ...]) -> str:
    """The one capture folder or scenario that all cameras are of; empty when there is none."""
    origins = {camera.source.rpartition("#")[0] for camera in cameras}
    simulated = any(camera.source.startswith(SIM) for camera in cameras)
    if simulated and (len(origins) > 1 or origins == {""}):
        raise ConfigError(
            "simulated cameras must all be of one scenario",
            "camera",
            "write source = sim:SCENARIO#CAMERA for each",
        )
    return origins.pop() if len(origins) == 1 else ""


def _merged(own: TrackerInputs, told: TrackerInputs) -> TrackerInputs:
    """What the configuration itself gives goes before what came with the cameras."""
    return replace(
        told,
        rig=own.rig or told.rig,
        model=own.model or told.model,
        white_balance={**told.white_balance, **own.white_balance},
    )
