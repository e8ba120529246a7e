"""The time of every frame of a video file, by the file's own stamps.

A header states one rate, and many files do not keep to it: phones record variable rates, recorders drop frames, and an
audio track may begin before the video. The frames' stamps show all of it; a few formats (raw H.264) hold none.
"""

from dataclasses import dataclass
from pathlib import Path

import mocapd.capture.environment  # noqa: F401  isort: skip  before cv2

import cv2
import numpy as np
from numpy.typing import NDArray

from mocapd.capture.file import FASTEST_HZ, SLOWEST_HZ, probe_video
from mocapd.errors import InputError
from mocapd.types import Floats

_LONGEST_GAP_S = 60.0  # a longer one is a damaged stamp
_REORDERED = 16  # frames at most that H.264 and its like store before one that is shown earlier
_ROUNDING_S = 1.5e-3  # Matroska stamps whole milliseconds
_UNEVEN = (
    0.15  # of a period, by which steps of a constant rate may differ: rounding of coarse time bases
)


@dataclass(frozen=True, slots=True, eq=False)
class VideoTimes:
    """When each of a file's F frames is shown.

    times_s (F,): since the first frame, rising [s]; where the stamps are unknown, index / rate_hz. rate_hz: the frames per
    second between gaps. gaps (G,2): frame before each gap, and how many frames are missing after it. is_constant: all
    steps are one period, so there is no gap either. start_s: the file's own time of the first frame, to half a
    period: above 0 where an audio track begins earlier. unknown: why the stamps cannot be used; empty when they can.
    """

    times_s: Floats
    rate_hz: float
    gaps: NDArray[np.int_]
    is_constant: bool
    start_s: float = 0.0
    unknown: str = ""


def video_times(path: Path, most_frames: int | None = None) -> VideoTimes:
    """Read the stamps of a file's frames, or of its first `most_frames`: all of them are decoded for it, at some
    thousand a second. Raises InputError when the file is missing, damaged or empty."""
    header = probe_video(path)
    stamps_s, periods = _stamps(path, most_frames, [])
    if len(stamps_s) == 0:
        raise InputError(
            "the video holds no frame that can be decoded", str(path), "record it again"
        )
    return times_of_stamps(stamps_s, header.fps_hz, periods[0] / header.fps_hz)


def stored_times(path: Path, most_frames: int | None = None) -> VideoTimes:
    """The same for every frame that the file stores, whether it can be decoded or not: none is decoded, which takes a
    fiftieth of the time. Where frames are stored in another order than shown, and not at a constant rate, their stamps
    may be damaged: there it is `video_times`. Raises InputError as that."""
    header = probe_video(path)
    most = None if most_frames is None else most_frames + _REORDERED
    stamps_s, periods = _stamps(path, most, [cv2.CAP_PROP_FORMAT, -1])  # as stored
    order = np.argsort(stamps_s, kind="stable")[:most_frames]
    if len(order) == 0:
        return video_times(path, most_frames)
    times = times_of_stamps(stamps_s[order], header.fps_hz, periods[order[0]] / header.fps_hz)
    believed = times.is_constant or (np.diff(order) == 1).all()
    return times if believed and not times.unknown else video_times(path, most_frames)


def _stamps(path: Path, most_frames: int | None, how: list[int]) -> tuple[Floats, Floats]:
    """Of the frames (F,) of a file opened so [s], also in periods of the header's rate, which are whole."""
    capture = cv2.VideoCapture(str(path), cv2.CAP_FFMPEG, [*how, cv2.CAP_PROP_N_THREADS, 1])
    stamps_ms: list[float] = []
    periods: list[float] = []
    try:
        while (most_frames is None or len(stamps_ms) < most_frames) and capture.grab():
            stamps_ms.append(capture.get(cv2.CAP_PROP_POS_MSEC))
            periods.append(capture.get(cv2.CAP_PROP_PTS))
    finally:
        capture.release()
    return 1e-3 * np.array(stamps_ms), np.array(periods)


def times_of_stamps(stamps_s: Floats, header_hz: float, start_s: float = 0.0) -> VideoTimes:
    """Times from stamps (F,) [s] and the header's rate; `start_s` is the file's time of the first frame."""
    unknown = _stamp_trouble(stamps_s)
    no_gaps = np.empty((0, 2), dtype=np.int_)
    if unknown:
        by_index: Floats = np.arange(len(stamps_s), dtype=np.float64) / header_hz
        return VideoTimes(by_index, header_hz, no_gaps, True, 0.0, unknown)
    if not np.isfinite(start_s) or not 0.0 <= start_s <= _LONGEST_GAP_S:
        start_s = 0.0
    times_s = stamps_s - stamps_s[0]
    steps_s = np.diff(times_s)
    if len(steps_s) == 0:
        return VideoTimes(times_s, header_hz, no_gaps, True, start_s)
    period_s = _period_s(steps_s, 1.0 / header_hz)
    limit_s = max(_ROUNDING_S, _UNEVEN * period_s)
    missing = np.maximum(np.round(steps_s / period_s).astype(np.int_) - 1, 0)
    off_s = np.abs(steps_s - (missing + 1) * period_s)
    at = np.flatnonzero((missing > 0) & (off_s < np.maximum(limit_s, 0.25 * period_s)))
    gaps = np.column_stack([at, missing[at]])
    is_constant = bool((off_s < limit_s).all()) and len(at) == 0
    if is_constant:
        times_s = (
            np.arange(len(times_s), dtype=np.float64) * period_s
        )  # without the rounding of the stamps
    return VideoTimes(times_s, 1.0 / period_s, gaps, is_constant, start_s)


def _stamp_trouble(stamps_s: Floats) -> str:
    """Why stamps cannot be believed; empty when they can."""
    if not np.isfinite(stamps_s).all():
        return "the file's stamps are no numbers"
    steps_s = np.diff(stamps_s)
    if len(steps_s) and not (stamps_s != stamps_s[0]).any():
        return "the file holds no stamps"
    if (steps_s <= 0).any():
        return "the file's stamps do not rise"
    if (steps_s > _LONGEST_GAP_S).any():
        return "the file's stamps jump by over a minute"
    if len(steps_s) and not SLOWEST_HZ <= 1.0 / float(np.median(steps_s)) <= FASTEST_HZ:
        return "the file's stamps give a rate that no camera has"
    return ""


def _period_s(steps_s: Floats, header_s: float) -> float:
    """The usual step. The header's, which is exact, where the stamps agree with it all the way."""
    usual_s = float(np.median(steps_s))
    whole = np.maximum(np.round(steps_s / usual_s), 1.0)
    near = np.abs(steps_s - whole * usual_s) < max(_ROUNDING_S, _UNEVEN * usual_s)
    mean_s = float(steps_s[near].sum() / whole[near].sum())
    drift_s = abs(mean_s - header_s) * float(whole[near].sum())
    return header_s if drift_s < _ROUNDING_S else mean_s
