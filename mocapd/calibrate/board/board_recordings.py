"""A folder of recordings of the board: a video or a folder of pictures per camera, named like the camera."""

import itertools
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import mocapd.capture.environment  # noqa: F401  isort: skip  before cv2

import cv2
import numpy as np

from mocapd.boundary.files import read_file
from mocapd.boundary.image_decoding import MOST_FILE_BYTES, decode_picture
from mocapd.boundary.listing import shown_in
from mocapd.capture.file import FileSource, probe_video
from mocapd.capture.video_times import video_times
from mocapd.errors import EndOfStream, InputError, MalformedError
from mocapd.types import Bytes

_VIDEOS = {
    *(".mp4", ".mkv", ".avi", ".mov", ".webm", ".m4v", ".mjpeg", ".mjpg", ".wmv", ".mpg", ".mpeg"),
    *(".ts", ".mts", ".m2ts", ".3gp", ".flv", ".ogv"),
}
_PICTURES = {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".webp"}
_USUAL_HZ = 30.0  # of numbered pictures
# magic numbers of formats whose size OpenCV checks, against the limit that `environment` sets
_OTHERS = (b"BM", b"II*\0", b"MM\0*", b"RIFF")


@dataclass(frozen=True, slots=True)
class RecordingTimes:
    """stamps_s[index] [s] from the start of the file, and the usual time between frames. For pictures with numbers in
    their names the time is that number at a usual rate."""

    stamps_s: Mapping[int, float]
    period_s: float


@dataclass(frozen=True, slots=True)
class Recording:
    """One camera's video or folder of pictures; `frames`: how many, 0 where a video does not say."""

    name: str
    path: Path
    frames: int
    size_px: tuple[int, int]

    def stamps(self) -> RecordingTimes:
        """Times of the frames by the file's own stamps. Raises InputError."""
        if self.path.is_dir():
            indices = [index for index, _ in pictures_by_index(self.path)]
            return RecordingTimes({i: i / _USUAL_HZ for i in indices}, 1.0 / _USUAL_HZ)
        times = video_times(self.path)
        stamps_s = dict(enumerate((times.start_s + times.times_s).tolist()))
        return RecordingTimes(stamps_s, 1.0 / times.rate_hz)

    def pictures(self, stride: int = 1) -> Iterator[tuple[int, Bytes]]:
        """Index and pixels of every `stride`-th index: frames in order, pictures by the number in their name.

        Raises InputError for a picture that is damaged or of another size.
        """
        if self.path.is_dir():
            for index, path in pictures_by_index(self.path):
                if index % stride == 0:
                    yield index, self._read(path)
            return
        source = FileSource(self.name, self.path)
        source.open()
        try:
            for index in itertools.count():
                frame = source.read()
                if index % stride == 0:
                    yield index, frame.pixels
        except EndOfStream:
            return
        finally:
            source.close()

    def _read(self, path: Path) -> Bytes:
        pixels = read_picture(path)
        if pixels.shape[1::-1] != self.size_px:
            raise InputError(
                f"is {pixels.shape[1]}x{pixels.shape[0]}, the first picture of this camera "
                f"{self.size_px[0]}x{self.size_px[1]}",
                str(path),
                "a lens is of one size of picture: leave the others out",
            )
        return pixels


def read_picture(path: Path) -> Bytes:
    """(h,w,3) uint8 BGR. Raises InputError."""
    data = read_file(path, MOST_FILE_BYTES)
    try:
        if data.startswith(_OTHERS):
            return _decode_other(data)
        return decode_picture(data, cv2.IMREAD_COLOR, most_bits=16)
    except MalformedError as error:
        raise InputError(error.what, str(path), "take it out of the folder") from None


def _decode_other(data: bytes) -> Bytes:
    """A BMP, TIFF or WebP as (h,w,3) uint8 BGR. Raises MalformedError."""
    try:
        pixels = cv2.imdecode(np.frombuffer(data, dtype=np.uint8), cv2.IMREAD_COLOR)
    except cv2.error as error:
        raise MalformedError(f"cannot be decoded ({error.err})") from None
    if pixels is None:
        raise MalformedError("is damaged or cut short")
    return np.asarray(pixels, dtype=np.uint8)


def pictures_by_index(folder: Path) -> list[tuple[int, Path]]:
    """The pictures of a folder by index: the last number in their names, else their order."""
    paths = [path for path in shown_in(folder) if path.suffix.lower() in _PICTURES]
    numbers = [re.findall(r"\d+", path.stem) for path in paths]
    if all(numbers):
        indices = [int(number[-1]) for number in numbers]
        if len(set(indices)) == len(indices):
            return sorted(zip(indices, paths, strict=True))
    return list(enumerate(paths))


def find_recordings(folder: Path) -> tuple[Recording, ...]:
    """Every camera of the folder, by name. Raises InputError for none, or for two of one name."""
    if not folder.is_dir():
        raise InputError("no such folder", str(folder), "check the path")
    recordings = []
    ignored = []
    for path in shown_in(folder):
        if pictures := pictures_by_index(path):
            shape = read_picture(pictures[0][1]).shape
            recordings.append(Recording(path.name, path, len(pictures), (shape[1], shape[0])))
        elif path.suffix.lower() in _VIDEOS:
            info = probe_video(path)
            recordings.append(Recording(path.stem, path, info.frames, info.size_px))
        else:
            ignored.append(path.name)
    names = [recording.name for recording in recordings]
    if not recordings or len(set(names)) < len(names):
        twice = sorted({name for name in names if names.count(name) > 1})
        others = f" that can be read, but {', '.join(ignored)[:200]}" if ignored else ""
        raise InputError(
            f"two recordings of one camera: {', '.join(twice)}"
            if twice
            else f"no recording in it{others}",
            str(folder),
            "put one video, or one folder of pictures, per camera there, named as the camera",
        )
    return tuple(recordings)
