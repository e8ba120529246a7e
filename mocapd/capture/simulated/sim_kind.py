"""A simulated webcam as a kind of source, `sim:SCENARIO#CAMERA`, and its scenario as the origin.

`sim:SCENARIO@FILE.json#CAMERA` sits in a simulated USB socket, from which it is plugged out by changing that file.
"""

from functools import partial
from pathlib import Path

from mocapd.assets import asset_path
from mocapd.boundary.files import user_path
from mocapd.capture.base import Source
from mocapd.capture.camera_link import CameraLink
from mocapd.capture.kinds.source_kind import SourceKind
from mocapd.capture.origin import Origin, OriginKind, Progress
from mocapd.capture.source_request import SourceRequest
from mocapd.errors import ConfigError, InputError

_PREFIX = "sim:"
_SOCKETS_SUFFIX = ".json"


def _scenario_path(address: str) -> Path:
    """The file of `sim:NAME`, one of calib/scenarios, or of `sim:FILE.toml`; `#CAMERA` is ignored.

    Raises InputError for a name that does not exist.
    """
    name, _ = _split(address)
    if name.endswith(".toml"):
        return user_path(name)
    scenarios = {file.stem: file for file in asset_path("scenarios").glob("*.toml")}
    if name not in scenarios:
        raise InputError(
            f"there is no scenario {name!r}",
            address,
            f"one of {', '.join(sorted(scenarios))}, or a .toml file",
        )
    return scenarios[name]


def _split(address: str) -> tuple[str, str]:
    """Scenario and file of the sockets, which may be empty."""
    name = address.removeprefix(_PREFIX).partition("#")[0]
    scenario, _, sockets = name.rpartition("@")
    return (scenario, sockets) if scenario and sockets.endswith(_SOCKETS_SUFFIX) else (name, "")


def scenario_address(name: str) -> str:
    """The origin's name of a scenario in calib/scenarios."""
    return f"{_PREFIX}{name}"


def _matches(address: str) -> bool:
    return address.startswith(_PREFIX)


def _open(address: str, _request: SourceRequest) -> Source:
    # all those of a scenario share a film, so its origin gives them
    raise ConfigError(
        "a simulated camera among others", address, "simulate all cameras, or none of them"
    )


def _cameras(origin: str) -> tuple[str, ...]:
    from mocapd.sim.scenario import load_scenario

    return tuple(camera.name for camera in load_scenario(_scenario_path(origin)).cameras)


def _open_origin(
    origin: str, cache_dir: Path, progress: Progress, is_beginning: bool = False
) -> Origin:
    # what draws is imported for such cameras only: it takes a second
    from mocapd.capture.simulated.film_origin import open_film
    from mocapd.capture.simulated.sockets import Sockets
    from mocapd.sim.scenario import load_scenario

    _, file = _split(origin)
    sockets = Sockets(user_path(file)) if file else None
    scenario = load_scenario(_scenario_path(origin))
    return open_film(origin, scenario, cache_dir, progress, sockets, is_beginning)


def _is_made(origin: str, cache_dir: Path) -> bool:
    from mocapd.sim.film import is_rendered
    from mocapd.sim.scenario import load_scenario

    return is_rendered(load_scenario(_scenario_path(origin)), cache_dir)


SIM = SourceKind(
    form="sim:SCENARIO#camN",
    link=CameraLink.PLAYER,
    matches=_matches,
    open=_open,
    is_simulated=True,
    origin=OriginKind(_cameras, _open_origin, partial(_open_origin, is_beginning=True), _is_made),
)
