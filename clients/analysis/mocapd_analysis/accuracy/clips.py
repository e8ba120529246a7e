"""Clips of real motion as curves in time, whose speed is known exactly."""

import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline
from scipy.signal import butter, sosfiltfilt

from mocapd.errors import InputError
from mocapd.geometry import rotations
from mocapd.types import Floats

WRISTS = ("leftHand", "rightHand")
# Nothing above it can be in a recording of 30 Hz. The clips, converted from other formats, have jumps of single
# frames, which no arm makes: up to 40 % of their largest speed lies above 18 Hz.
BAND_HZ = 15.0
_FIELDS = ("fps", "names", "parents", "rest_offsets", "global_quats", "hips_pos")


@dataclass(frozen=True, slots=True, eq=False)
class Clip:
    """names (J,); parents (J,); rest_offsets_m (J,3); hips_m (F,3); global_xyzw (F,J,4) at rate_hz."""

    rate_hz: float
    names: tuple[str, ...]
    parents: tuple[int, ...]
    rest_offsets_m: Floats
    hips_m: Floats
    global_xyzw: Floats

    def joints_m(self) -> Floats:
        """Every joint's way (F,J,3) [m]."""
        places = np.empty((*self.global_xyzw.shape[:2], 3))
        for joint, parent in enumerate(self.parents):
            if parent < 0:
                places[:, joint] = self.hips_m
            else:
                offset = np.broadcast_to(self.rest_offsets_m[joint], self.hips_m.shape)
                turned = rotations.rotate(self.global_xyzw[:, parent], offset)
                places[:, joint] = places[:, parent] + turned
        return places


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """A wrist's way as a curve of degree 5 from 0 to end_s, and its largest speed, away from the ends."""

    joint: str
    way_m: BSpline
    end_s: float
    peak_m_s: float


def read_clips(folder: Path) -> list[Clip]:
    """Every clip of a folder, by name. Raises InputError."""
    paths = sorted(folder.glob("[!.]*.npz")) if folder.is_dir() else []
    if not paths:
        raise InputError("has no clips (*.npz)", str(folder), "give a folder of clips of motion")
    return [_read_clip(path) for path in paths]


def _read_clip(path: Path) -> Clip:
    fix = "give a folder of clips of motion, and nothing else in it"
    try:
        with np.load(path, allow_pickle=False) as data:
            missing = [field for field in _FIELDS if field not in data.files]
            if missing:
                raise InputError(f"is no clip: it lacks {', '.join(missing)}", str(path), fix)
            fields = {field: np.asarray(data[field]) for field in _FIELDS}
    except (OSError, ValueError, EOFError, zipfile.BadZipFile) as error:
        raise InputError(f"is damaged or no clip ({error})", str(path), fix) from None
    return Clip(
        float(fields["fps"]),
        tuple(str(name) for name in fields["names"]),
        tuple(int(parent) for parent in fields["parents"]),
        fields["rest_offsets"].astype(float),
        fields["hips_pos"].astype(float),
        fields["global_quats"].astype(float),
    )


def courses(clips: list[Clip], band_hz: float | None, least_m_s: float) -> list[Course]:
    """The wrists that get as fast as `least_m_s`, as they are (None) or without what is above `band_hz`."""
    found = []
    for clip in clips:
        joints_m = clip.joints_m()
        for joint in WRISTS:
            if joint in clip.names:
                way_m = joints_m[:, clip.names.index(joint)]
                course = _course(clip, joint, way_m, band_hz)
                if course.peak_m_s >= least_m_s:
                    found.append(course)
    return found


def _course(clip: Clip, joint: str, way_m: Floats, band_hz: float | None) -> Course:
    if band_hz is not None:
        band = butter(2, band_hz / (0.5 * clip.rate_hz), output="sos")
        way_m = sosfiltfilt(band, way_m, axis=0)
    times_s = np.arange(len(way_m)) / clip.rate_hz
    curve = make_interp_spline(times_s, way_m, k=5)
    dense_s = np.arange(END_S, times_s[-1] - END_S, 0.002)
    speed = np.linalg.norm(curve.derivative()(dense_s), axis=1)
    return Course(joint, curve, float(times_s[-1]), float(speed.max()))


END_S = (
    0.1  # at either end of a clip nothing is compared: there the truth is an end of a spline too
)
