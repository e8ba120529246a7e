"""The ground truth of a capture. Only this package may read it: no tracker ever sees it."""

import zipfile
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mocapd.errors import InputError
from mocapd.geometry.rig_file import read_json
from mocapd.types import Floats

_FIELDS = ("times", "names", "joints", "visible")
_RESTORE = "copy the capture again"
_MOST_BYTES = 200_000_000  # of the unpacked fields: more than an hour at 60 Hz


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """times_s (F,): middle of the exposure since the capture's start [s]; joints_m (F,J,3) [m, world],
    NaN without a person; visible (F,); light_change_s: when a lamp goes out, None if none does; clear_s: the end of the
    occlusion, None if unknown."""

    names: tuple[str, ...]
    times_s: Floats
    joints_m: Floats
    visible: NDArray[np.bool_]
    light_change_s: float | None
    clear_s: float | None = None


def load_truth(capture: Path) -> Truth:
    """Read truth.npz, and info.json where there is one. Raises InputError naming the file."""
    path = capture / "truth.npz"
    if not path.is_file():
        raise InputError(
            "no ground truth, so there is nothing to score against",
            str(path),
            "choose a capture with a truth.npz, or use `mocapd track`",
        )
    light_change_s, clear_s = _events_s(capture / "info.json")
    try:
        _check_size(path)
        with np.load(path, allow_pickle=False) as data:
            missing = [field for field in _FIELDS if field not in data.files]
            if missing:
                raise InputError(f"lacks {', '.join(missing)}", str(path), _RESTORE)
            truth = Truth(
                names=tuple(str(name) for name in data["names"]),
                times_s=data["times"].astype(float),
                joints_m=data["joints"].astype(float),
                visible=data["visible"].astype(bool),
                light_change_s=light_change_s,
                clear_s=clear_s,
            )
    except (OSError, ValueError, MemoryError, zipfile.BadZipFile, zlib.error) as error:
        raise InputError(f"cannot be read ({error})", str(path), _RESTORE) from None
    frames, joints = len(truth.times_s), len(truth.names)
    if truth.joints_m.shape != (frames, joints, 3) or truth.visible.shape != (frames,):
        raise InputError("its arrays are not of one length", str(path), _RESTORE)
    if not truth.visible.any():
        raise InputError("nobody is visible in this capture", str(path), "choose another one")
    return truth


def _check_size(path: Path) -> None:
    """Raises InputError for a small archive that unpacks to more than the memory, BadZipFile for none."""
    with zipfile.ZipFile(path) as archive:
        fields = [f for f in archive.infolist() if f.filename.removesuffix(".npy") in _FIELDS]
    if sum(field.file_size for field in fields) > _MOST_BYTES:
        raise InputError(f"unpacks to more than {_MOST_BYTES / 1e6:g} MB", str(path), _RESTORE)


def _events_s(path: Path) -> tuple[float | None, float | None]:
    """When a lamp goes out and when an occlusion ends, of an info.json if there is one. Raises InputError naming it."""
    info = read_json(path) if path.is_file() else {}
    try:
        return _light_change_s(info), float(info["clear_s"]) if "clear_s" in info else None
    except (AttributeError, KeyError, TypeError, ValueError):
        raise InputError(
            "does not say as numbers when lamps go out and when an occlusion ends",
            str(path),
            _RESTORE,
        ) from None


def _light_change_s(info: dict[str, Any]) -> float | None:
    """`light_event.lamp_off_s` of a recorded capture, or the first lamp that the simulator dims."""
    event: Any = info.get("light_event")
    if event:
        return float(event["lamp_off_s"])
    dimmed = [
        float(t_s)
        for events in info.get("light_events", {}).values()
        for (t_s, level), (_, before) in zip(events, [(0.0, 1.0), *events], strict=False)
        if level < before
    ]
    return min(dimmed, default=None)
