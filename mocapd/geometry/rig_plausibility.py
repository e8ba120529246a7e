"""Checks that a rig's distances are plausible for a room, which reveals a wrong unit."""

from itertools import combinations

import numpy as np

from mocapd.errors import ConfigError
from mocapd.geometry.camera_model import centre
from mocapd.types import Rig

_FARTHEST_M = 60.0  # of cameras from each other, and from the middle of the floor: a large hall
_USUAL_M = (0.3, 20.0)  # of a camera from the middle of the floor
# metres per unit that other programs write
_UNITS = {"millimetres": 1e-3, "centimetres": 1e-2, "inches": 0.0254, "feet": 0.3048}


def require_plausible(rig: Rig, where: str) -> None:
    """Raises ConfigError, naming distances and the likely unit, for cameras that fit no room."""
    centres = {camera.name: centre(camera) for camera in rig.cameras}
    farthest = max(centres, key=lambda name: float(np.linalg.norm(centres[name])))
    away_m = float(np.linalg.norm(centres[farthest]))
    for one, other in combinations(centres, 2):
        apart_m = float(np.linalg.norm(centres[one] - centres[other]))
        if apart_m > _FARTHEST_M:
            raise ConfigError(
                f"cameras {one!r} and {other!r} would be {_length(apart_m)} apart",
                where,
                _mend(away_m),
            )
    if away_m > _FARTHEST_M:
        raise ConfigError(
            f"camera {farthest!r} would be {_length(away_m)} from the middle of the floor",
            where,
            _mend(away_m),
        )


def _length(length_m: float) -> str:
    return f"{length_m / 1e3:.1f} km" if length_m >= 1e3 else f"{length_m:.0f} m"


def _mend(away_m: float) -> str:
    """The error with the unit that would be plausible."""
    low, high = _USUAL_M
    middle = float(np.sqrt(low * high))
    fitting = [name for name, unit_m in _UNITS.items() if low <= away_m * unit_m <= high]
    if not fitting:
        return "'t' is in metres: correct the file"
    best = min(fitting, key=lambda name: abs(np.log(away_m * _UNITS[name] / middle)))
    return f"'t' is in metres, and looks like {best}: multiply it by {_UNITS[best]:g}"
