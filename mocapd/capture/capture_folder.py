"""A folder in the capture format: rig.json, camN.mp4, subject.json, scribble/, model/."""

import logging
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from mocapd.boundary.files import is_absent, is_file, is_folder
from mocapd.boundary.listing import shown_in
from mocapd.boundary.numbers import brief, finite_number
from mocapd.capture.file import FASTEST_HZ, SLOWEST_HZ, FileSource, check_size, probe_video
from mocapd.capture.frame_groups import as_set, due_frames, half_period_ns
from mocapd.capture.pace import Pace
from mocapd.capture.video_times import stored_times
from mocapd.errors import ConfigError, EndOfStream, InputError, MalformedError
from mocapd.geometry.rig_file import load_rig, read_json
from mocapd.shirt.colour.strokes import require_pictures, stroked_pictures, strokes_path
from mocapd.types import Frame, FrameSet, Rig

_LOG = logging.getLogger(__name__)
_MOST_OFFSET_S = 86_400.0  # of a camera's clock from the others'
_TIMED_FRAMES = 900  # their stamps give a file's rate
_SAME_RATE = 0.005  # of a rate: 29.97 and 30 are one to people
STATURES_M = (0.5, 2.6)


@dataclass(frozen=True, slots=True)
class RecordedCamera:
    """Frame f is exposed at f / fps_hz + time_offset_s [s], or, where the rate varies (`stamped`), at the file's stamp since
    its first frame, + time_offset_s. start_s: the file's stamp of its first frame. `scribble`: an image with strokes in
    a second file; None without. lost: frame ranges, end exclusive, in which the camera was unplugged and its video
    holds filler frames."""

    name: str
    video: Path
    size_px: tuple[int, int]  # width, height
    fps_hz: float
    time_offset_s: float
    frames: int
    scribble: Path | None
    lost: tuple[tuple[int, int], ...] = ()
    stamped: bool = False
    start_s: float = 0.0

    def has(self, frame: int) -> bool:
        """True if the camera was plugged in at that frame."""
        return not any(first <= frame < last for first, last in self.lost)


@dataclass(frozen=True, slots=True, eq=False)
class CaptureFolder:
    """A recorded session; `cameras` in the rig's order. `stature_m` is None where no subject is given.

    `model`: images of the shirt in neutral light with stroke files, for the offline colour model.
    """

    path: Path
    rig: Rig
    cameras: tuple[RecordedCamera, ...]
    stature_m: float | None
    model: tuple[Path, ...]

    @property
    def fps_hz(self) -> float:
        """The rate of the fastest camera."""
        return max(camera.fps_hz for camera in self.cameras)


def load_folder(path: Path) -> CaptureFolder:
    """Read and check a capture folder; every video is opened once.

    Raises InputError (something is missing or damaged) or ConfigError (a value is wrong, a video's
    size is not that of its calibration, or the cameras' rates differ).
    """
    if not is_folder(path):
        what = "no such capture folder" if is_absent(path) else "is no capture folder"
        raise InputError(what, str(path), "give a folder with rig.json and the cameras' videos")
    rig_path = path / "rig.json"
    rig = load_rig(rig_path)
    entries = read_json(rig_path)["cameras"]
    _require_videos(path, entries)
    require_pictures(path / "scribble")
    cameras = tuple(
        _camera(path, entry, camera.size_px)
        for entry, camera in zip(entries, rig.cameras, strict=True)
    )
    cameras = _apply_start_times(cameras)
    return CaptureFolder(
        path, rig, cameras, _stature_m(path / "subject.json"), _model(path / "model")
    )


def _require_videos(folder: Path, entries: list[dict[str, Any]]) -> None:
    """Raises InputError that names each camera without a video, and each video without a camera."""
    videos = {entry["name"]: _video_name(folder, entry) for entry in entries}
    missing = [
        f"{file} of camera {name!r}" for name, file in videos.items() if not is_file(folder / file)
    ]
    if not missing:
        return
    kinds = {Path(file).suffix.lower() for file in videos.values()}
    others = [
        file.name
        for file in shown_in(folder)
        if file.suffix.lower() in kinds and file.name not in videos.values()
    ]
    of_none = f"; {', '.join(others)[:200]} is of no camera" if others else ""
    raise InputError(
        f"no such video file: {', '.join(missing)}{of_none}",
        str(folder),
        "put it there, or correct 'file' in rig.json, or take the camera out of rig.json",
    )


def _video_name(folder: Path, entry: dict[str, Any]) -> str:
    file = entry.get("file", f"{entry['name']}.mp4")
    if not isinstance(file, str):
        where = f"{folder / 'rig.json'}, camera {entry['name']!r}"
        raise ConfigError(
            f"'file' must be a file name, is {brief(file)}", where, "correct the file"
        )
    return file


def _apply_start_times(cameras: tuple[RecordedCamera, ...]) -> tuple[RecordedCamera, ...]:
    """Adds the files' start times to the offsets: first frames differ in time where an audio track begins earlier, or
    where files were cut at a common instant."""
    first_s = min(camera.start_s for camera in cameras)
    return tuple(
        replace(camera, time_offset_s=camera.time_offset_s + camera.start_s - first_s)
        if camera.start_s > first_s
        else camera
        for camera in cameras
    )


def _number(value: object, key: str, low: float, high: float, where: str) -> float:
    try:
        return finite_number(value, low, high)
    except MalformedError as error:
        raise ConfigError(f"{key!r}: {error.what}", where, "correct the file") from None


def _camera(folder: Path, entry: dict[str, Any], size_px: tuple[int, int]) -> RecordedCamera:
    name: str = entry["name"]
    where = f"{folder / 'rig.json'}, camera {name!r}"
    file = _video_name(folder, entry)
    video = folder / file
    info = probe_video(video)
    check_size(str(video), name, info.size_px, size_px)
    offset_s = entry.get("time_offset_s", 0.0)
    stated_hz = _number(entry.get("fps", info.fps_hz), "fps", SLOWEST_HZ, FASTEST_HZ, where)
    times = stored_times(video, _TIMED_FRAMES)
    if not times.unknown and abs(times.rate_hz / stated_hz - 1.0) > _SAME_RATE:
        _LOG.warning(
            "%s: 'fps' is %g, but the frames of %s are stamped at %.4g Hz: the stamps are used -- correct 'fps'",
            *(where, stated_hz, file, times.rate_hz),
        )
    if len(times.gaps):
        _LOG.warning(
            "%s: %d frames are missing in %d places; the others keep the times of their stamps",
            *(video, int(times.gaps[:, 1].sum()), len(times.gaps)),
        )
    return RecordedCamera(
        name=name,
        video=video,
        size_px=size_px,
        fps_hz=stated_hz if times.unknown else times.rate_hz,
        time_offset_s=_number(offset_s, "time_offset_s", -_MOST_OFFSET_S, _MOST_OFFSET_S, where),
        frames=info.frames,
        scribble=_image_with_strokes(folder / "scribble" / f"{Path(file).stem}.png"),
        lost=_lost(entry.get("lost_frames", []), info.frames, where),
        stamped=not times.is_constant,
        start_s=times.start_s,
    )


def _lost(value: object, frames: int, where: str) -> tuple[tuple[int, int], ...]:
    """Checked frame ranges of a video with `frames` frames."""
    spans: list[Any] = value if isinstance(value, list) else [value]
    if not all(isinstance(span, list) and len(span) == 2 for span in spans):
        raise ConfigError(
            f"'lost_frames' must be pairs of frames, is {brief(value)}", where, "correct the file"
        )
    pairs = ([int(_number(n, "lost_frames", 0, frames, where)) for n in span] for span in spans)
    return tuple((first, last) for first, last in pairs)


def _stature_m(path: Path) -> float | None:
    if is_absent(path):
        return None
    fix = 'write the person\'s height in metres, as {"stature_m": 1.72}'
    subject = read_json(path)
    if not isinstance(subject, dict) or "stature_m" not in subject:
        raise ConfigError("the field 'stature_m' is missing", str(path), fix)
    try:
        return finite_number(subject["stature_m"], *STATURES_M)
    except MalformedError as error:
        raise ConfigError(f"'stature_m': {error.what}", str(path), fix) from None


def _image_with_strokes(image: Path) -> Path | None:
    """The image; None without one. Raises InputError for an image without a stroke file."""
    if is_absent(image):
        return None
    strokes = strokes_path(image)
    if is_absent(strokes):
        raise InputError("the strokes of this image are missing", str(strokes), "draw them again")
    return image


def _model(folder: Path) -> tuple[Path, ...]:
    images = (_image_with_strokes(image) for image in stroked_pictures(folder))
    return tuple(image for image in images if image is not None)


def folder_source(camera: RecordedCamera, pace: Pace, name: str | None = None) -> FileSource:
    """The source of one camera; `name` overrides the camera's own.

    The cameras of a folder share a live `pace`, so that they stay synchronised.
    """
    return FileSource(
        name or camera.name,
        camera.video,
        camera.fps_hz,
        camera.time_offset_s,
        pace=pace,
        size_px=camera.size_px,
        stamped=camera.stamped,
    )


def frame_sets(folder: CaptureFolder) -> Iterator[FrameSet]:
    """Sets of frames nearest in time, from time 0, as fast as they decode.

    Each frame carries its own time. A camera without a frame within half a period is absent, as one that ended or was
    unplugged.
    """
    pace = Pace(live=False)
    cameras = {camera.name: camera for camera in folder.cameras}
    for frames in sources_in_step([folder_source(camera, pace) for camera in folder.cameras]):
        present = {
            name: frame for name, frame in frames.frames.items() if cameras[name].has(frame.seq)
        }
        if present:
            yield as_set(present)


def sources_in_step(sources: Sequence[FileSource]) -> Iterator[FrameSet]:
    """The same for any offline video sources, as videos without a rig; closes them at the end.

    A frame that does not decode is absent from its set; the frames after it keep their index and time.
    """
    with ExitStack() as opened:
        for source in sources:
            opened.callback(source.close)
            source.open()
        running = list(sources)
        ahead: dict[str, Frame] = {}  # per camera its next whole frame, not yet due
        while True:
            for source in tuple(running):
                if source.name in ahead:
                    continue
                try:
                    ahead[source.name] = source.read()
                except EndOfStream as end:
                    running.remove(source)
                    if end.fix:  # it ended before its time
                        _LOG.warning("%s", end)
            if not ahead:
                return
            present = {s.name: ahead[s.name] for s in sources if s.name in ahead}
            apart_ns = half_period_ns(max(source.fps_hz for source in sources))
            yield as_set({name: ahead.pop(name) for name in due_frames(present, apart_ns)})
