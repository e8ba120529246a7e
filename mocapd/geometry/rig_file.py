"""Rig files: JSON in the capture format, checked value by value before anything uses them.

Distances must be plausible for a room, which reveals a wrong unit.
"""

from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

from mocapd.boundary.files import read_text
from mocapd.boundary.numbers import brief
from mocapd.boundary.parsing import parse_json
from mocapd.errors import ConfigError, MalformedError, NewerFileError
from mocapd.geometry.camera_model import centre
from mocapd.types import Camera, Floats, Rig

SCHEMA = "mocapd.Rig.v1"  # also of files without a schema, as in the capture format
_RECALIBRATE = "calibrate again, or restore the file"
_MOST_BYTES = 1_000_000  # a camera takes 1 kB
_LARGEST_PX = 16_384  # of a picture's side
_LARGEST = 1e6  # of any other number, in its unit: pixels or metres
_FARTHEST_M = 60.0  # of cameras from each other, and from the middle of the floor: a large hall
_USUAL_M = (0.3, 20.0)  # of a camera from the middle of the floor
# metres per unit that other programs write
_UNITS = {"millimetres": 1e-3, "centimetres": 1e-2, "inches": 0.0254, "feet": 0.3048}


def _array(entry: dict[str, Any], key: str, shape: tuple[int, ...], where: str) -> Floats:
    if key not in entry:
        raise ConfigError(f"the field {key!r} is missing", where, _RECALIBRATE)
    try:
        value = np.asarray(entry[key], dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise ConfigError(f"{key!r} is not a list of numbers", where, _RECALIBRATE) from None
    if value.shape != shape:
        raise ConfigError(f"{key!r} has shape {value.shape}, wanted {shape}", where, _RECALIBRATE)
    if not np.isfinite(value).all():
        raise ConfigError(f"{key!r} contains NaN or infinity", where, _RECALIBRATE)
    if np.abs(value).max() > _LARGEST:
        raise ConfigError(f"{key!r} contains a number above 1e6", where, _RECALIBRATE)
    return value


def _distortion(entry: dict[str, Any], where: str) -> Floats:
    """k1 k2 p1 p2 k3 (5,); of four values, which OpenCV accepts too, k3 is 0."""
    given = entry.get("dist")
    if isinstance(given, list) and len(given) == 4:
        return np.append(_array(entry, "dist", (4,), where), 0.0)
    return _array(entry, "dist", (5,), where)


def camera_from_dict(entry: Any, where: str) -> Camera:
    """One camera of a rig file. Raises ConfigError naming the field."""
    name = entry.get("name") if isinstance(entry, dict) else None
    if not isinstance(name, str) or not name:
        raise ConfigError("a camera without a 'name'", where, _RECALIBRATE)
    where = f"{where}, camera {name!r}"
    size = _array(entry, "size", (2,), where)
    K = _array(entry, "K", (3, 3), where)
    R = _array(entry, "R", (3, 3), where)
    if size.min() < 16 or K[0, 0] <= 0 or K[1, 1] <= 0:
        raise ConfigError(
            "'size' and the focal lengths in 'K' must be positive", where, _RECALIBRATE
        )
    if size.max() > _LARGEST_PX or (size != np.round(size)).any():
        raise ConfigError("'size' is not width and height in whole pixels", where, _RECALIBRATE)
    if K[0, 1] != 0 or K[1, 0] != 0 or not np.array_equal(K[2], (0, 0, 1)):
        raise ConfigError("'K' is not [fx 0 cx, 0 fy cy, 0 0 1]", where, _RECALIBRATE)
    if np.abs(R @ R.T - np.eye(3)).max() > 1e-3:
        raise ConfigError("'R' is not a rotation matrix", where, _RECALIBRATE)
    if np.linalg.det(R) < 0:
        raise ConfigError(
            "'R' mirrors (its determinant is -1): the rig is of a left-handed world",
            where,
            "flip the sign of one column of R in all cameras, so that x is to the left of a person facing +z, and y up",
        )
    return Camera(
        name=name,
        size_px=(int(size[0]), int(size[1])),
        K=K,
        dist=_distortion(entry, where),
        R=R,
        t_m=_array(entry, "t", (3,), where),
    )


def read_json(path: Path) -> Any:
    """A JSON file. Raises InputError naming the file, and the line where it is damaged."""
    text = read_text(path, _MOST_BYTES)
    try:
        return parse_json(text)
    except MalformedError as error:
        raise ConfigError(f"not valid JSON ({error.what})", str(path), _RECALIBRATE) from None


def load_rig(path: Path) -> Rig:
    """Read a rig file. Raises InputError or ConfigError, naming file, camera and field."""
    data = read_json(path)
    schema = data.get("schema", SCHEMA) if isinstance(data, dict) else SCHEMA
    if schema != SCHEMA:
        raise NewerFileError(
            f"is a rig of the schema {brief(schema)}, this mocapd reads {SCHEMA}",
            str(path),
            "use the mocapd that wrote it, or calibrate again",
        )
    entries = data.get("cameras") if isinstance(data, dict) else None
    if not isinstance(entries, list) or not entries:
        raise ConfigError("the field 'cameras' is missing or empty", str(path), _RECALIBRATE)
    rig = Rig(tuple(camera_from_dict(entry, str(path)) for entry in entries))
    if len(set(rig.names)) != len(rig.names):
        raise ConfigError("two cameras have one name", str(path), "rename one of them")
    require_plausible(rig, str(path))
    return rig


def camera_to_dict(camera: Camera) -> dict[str, Any]:
    """The fields of one camera as a rig file holds them."""
    return {
        "name": camera.name,
        "size": list(camera.size_px),
        "K": camera.K.tolist(),
        "dist": camera.dist.tolist(),
        "R": camera.R.tolist(),
        "t": camera.t_m.tolist(),
    }


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
