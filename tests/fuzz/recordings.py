"""Captures and videos, opened and read to their end; single frames of webcams."""

import itertools
import json
import threading
from pathlib import Path
from random import Random

import cv2
import numpy as np

from mocapd.calibration.from_origin import from_capture
from mocapd.capture.camera_thread.thread import CaptureThread
from mocapd.capture.capture_folder import folder_source, frame_sets, load_folder
from mocapd.capture.file import FileSource
from mocapd.capture.pace import Pace
from mocapd.capture.webcam.v4l2 import decode
from mocapd.errors import EndOfStream, MocapdError
from mocapd.types import Bytes, Frame
from tests.capture import films
from tests.cli import small_capture
from tests.fuzz.damaged_pictures import damaged_jpeg, damaged_png, jpeg, sample
from tests.fuzz.mutations import JSON_VALUES, damaged, mistyped
from tests.fuzz.row import Attempt, DeadlyError, Place, each_of

_FRAMES = 6
_LIVE_S = 0.1  # how long a live recording is watched
_FILMS = {"mp4": "mp4v", "avi": "MJPG", "mkv": "mp4v"}
_LIVE_FPS = (1e-300, 1e-9, 0.01, 30.0, 1e6, 1e300, 1.7e308)
_LIVE_OFFSETS_S = (-1e308, -1e9, 1e9, 1e308)


def captures(place: Place) -> Attempt:
    """A capture folder one of whose files is damaged: its tables, pictures and every frame."""
    folder = small_capture.write_capture(place.folder / "capture")
    small_capture.write_stroked(folder / "scribble" / "cam0.png", range(1, 11))
    files = {path: path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}
    tables = [path for path in files if path.suffix == ".json"]
    others = [path for path in files if path.suffix != ".json"]

    def read() -> bool:
        capture = load_folder(folder)
        from_capture(capture)
        return len(list(frame_sets(capture))) > 0

    assert read()

    def attempt(random: Random, number: int) -> bool:
        path = random.choice(tables if random.random() < 0.7 else others)
        path.write_bytes(_spoilt(random, path, files[path]))
        try:
            return read()
        finally:
            path.write_bytes(files[path])

    return attempt


def _spoilt(random: Random, path: Path, data: bytes) -> bytes:
    if path.suffix == ".json":
        return mistyped(random, data, JSON_VALUES)
    return damaged_png(random, data) if path.suffix == ".png" else damaged(random, data)


def live_paces(place: Place) -> Attempt:
    """Rates and offsets of a capture that is played live, as the daemon does: in a capture thread."""
    folder = films.write_capture(place.folder / "capture", frames=(4, 4))
    path = folder / "rig.json"
    good = json.loads(path.read_text())

    def play(case: tuple[float, float]) -> bool:
        for camera in good["cameras"]:
            camera["fps"], camera["time_offset_s"] = case
        path.write_text(json.dumps(good))
        capture = load_folder(folder)
        source = folder_source(capture.cameras[0], Pace(live=True))
        return _watched(source)

    assert play((30.0, 0.0))
    return each_of(list(itertools.product(_LIVE_FPS, _LIVE_OFFSETS_S)), play)


class _Mailbox:
    """Where the capture thread's frames go."""

    def __init__(self) -> None:
        self.came = threading.Event()

    def put(self, item: Frame, /) -> None:
        self.came.set()


def _watched(source: FileSource) -> bool:
    """Whether a frame came; raises the named error that ended the thread, and DeadlyError for others."""
    mailbox = _Mailbox()
    deaths: list[BaseException] = []
    thread = CaptureThread(source, mailbox, deaths.append)
    thread.start()
    mailbox.came.wait(_LIVE_S)
    assert thread.stop(), "the capture thread does not end"
    for death in deaths:
        if isinstance(death, MocapdError):
            raise death
        raise DeadlyError(death)
    return mailbox.came.is_set()


def videos(place: Place) -> Attempt:
    """Damaged films in three containers, each read to its end."""
    goods = {kind: _film(place.folder / f"good.{kind}", codec) for kind, codec in _FILMS.items()}
    for kind in goods:
        assert _length(place.folder / f"good.{kind}") == _FRAMES
    kinds = tuple(goods)

    def attempt(random: Random, number: int) -> bool:
        kind = kinds[number % len(kinds)]
        path = place.folder / f"film.{kind}"
        path.write_bytes(damaged(random, goods[kind]))
        return _length(path) > 0

    return attempt


def _film(path: Path, codec: str) -> bytes:
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*codec), 30.0, films.SIZE_PX)
    assert writer.isOpened(), f"cv2 cannot write {path.suffix}"
    for index in range(_FRAMES):
        writer.write(films.picture(index))
    writer.release()
    return path.read_bytes()


def _length(path: Path) -> int:
    """How many frames come; never more than some times what there are."""
    source = FileSource("film", path)
    try:
        source.open()
        for count in range(100 * _FRAMES):
            try:
                source.read()
            except EndOfStream:
                return count
        raise AssertionError("the film does not end")
    finally:
        source.close()


def webcam_frames(place: Place) -> Attempt:
    """Buffers of a driver: MJPG and YUYV."""
    size_px = (64, 48)
    mjpg = jpeg(sample(size_px))
    yuyv = np.random.default_rng(1).integers(0, 255, size_px[0] * size_px[1] * 2, dtype=np.uint8)
    assert decode(_buffer(mjpg), "MJPG", size_px) is not None
    assert decode(yuyv, "YUYV", size_px) is not None

    def attempt(random: Random, number: int) -> bool:
        if number % 4:
            return decode(_buffer(damaged_jpeg(random, mjpg)), "MJPG", size_px) is not None
        return decode(_buffer(damaged(random, yuyv.tobytes())), "YUYV", size_px) is not None

    return attempt


def _buffer(data: bytes) -> Bytes:
    return np.frombuffer(data, np.uint8)
