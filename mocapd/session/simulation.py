"""Simulated webcams, `sim:SCENARIO#CAMERA`: the film they show and what their rig tells a tracker."""

import logging
from collections.abc import Sequence
from pathlib import Path

from mocapd.assets import asset_path
from mocapd.boundary.files import user_path
from mocapd.calibration.record import Calibration, ShirtColours, Wearer
from mocapd.capture.sim import SimSource
from mocapd.clock import monotonic_ns
from mocapd.config.sections import CameraSection
from mocapd.errors import InputError
from mocapd.session.camera_inputs import CameraInput, in_rig_order
from mocapd.session.tracker_setup import Progress
from mocapd.sim.film import Film, film_key, load_film
from mocapd.sim.scenario import load_scenario
from mocapd.sim.setup import SimSetup

_log = logging.getLogger(__name__)

SIM = "sim:"


def scenario_path(source: str) -> Path:
    """The file of `sim:NAME`, one of calib/scenarios, or of `sim:FILE.toml`; `#CAMERA` is ignored.

    Raises InputError for a name that does not exist.
    """
    name = source.removeprefix(SIM).partition("#")[0]
    if name.endswith(".toml"):
        return user_path(name)
    known = {one.stem: one for one in asset_path("scenarios").glob("*.toml")}
    if name not in known:
        raise InputError(
            f"there is no scenario {name!r}",
            source,
            f"one of {', '.join(sorted(known))}, or a .toml file",
        )
    return known[name]


def camera_names(source: str) -> tuple[str, ...]:
    """The cameras of a scenario. Raises InputError or ConfigError."""
    return tuple(camera.name for camera in load_scenario(scenario_path(source)).cameras)


def open_film(source: str, cache_dir: Path, progress: Progress) -> Film:
    """The scenario's film, rendered when it is not in the cache. Raises MocapdError."""
    scenario = load_scenario(scenario_path(source))
    what = "rendering the simulated webcams"
    if not any(cache_dir.glob(f"*{film_key(scenario)[:16]}*")):
        progress(what, 0, 1)  # something to see while the renderer is compiled
    return load_film(scenario, cache_dir, lambda done, total: progress(what, done, total))


def simulated_inputs(cameras: Sequence[CameraSection], film: Film) -> tuple[CameraInput, ...]:
    """Webcams that show one film; they share its beginning. Raises ConfigError."""
    rig = film.setup.rig
    sizes = {camera.name: camera.size_px for camera in rig.cameras}
    epoch_ns = monotonic_ns()
    # with this whoever watches can say where the simulated person was
    _log.info(
        "frame %d of the film %r is at %d ns of the monotonic clock, at %g Hz",
        *(film.first, film.scenario.name, epoch_ns, film.scenario.fps_hz),
    )
    return tuple(
        CameraInput(
            SimSource(film, camera.id, epoch_ns),
            camera.source,
            sizes[camera.id],
            film.scenario.fps_hz,
        )
        for camera in in_rig_order(cameras, rig)
    )


def from_scenario(setup: SimSetup) -> Calibration:
    """What a user's calibration of the simulated rig would know."""
    return Calibration(
        setup.rig, Wearer(setup.stature_m), ShirtColours(setup.model, setup.scribbles)
    )
