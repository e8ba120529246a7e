"""Mistakes made with the development captures: rig.json edited, videos encoded anew."""

import json
import shutil
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from mocapd.calibrate.consistency.findings import Mistake
from mocapd.types import Bytes

Cameras = list[dict[str, Any]]
EditRig = Callable[[Cameras], object]
Pictures = Sequence[Bytes]


@dataclass(frozen=True, slots=True)
class EditVideo:
    """What is done with one camera's pictures, and the rate (Hz) that the new file states."""

    camera: str
    edit: Callable[[Pictures], Iterable[Bytes]]
    fps_hz: float = 30.0


@dataclass(frozen=True, slots=True)
class WrongCapture:
    """A mistake: `wanted` are the reasons that count as right; 'refused': a ConfigError."""

    name: str
    capture: str
    wanted: tuple[str, ...]
    rig: EditRig | None = None
    videos: tuple[EditVideo, ...] = ()
    from_capture: str = ""  # whose videos of the same names are shown in place of those edited


def make_wrong(case: WrongCapture, captures: Path, folder: Path) -> Path:
    """The capture with its mistake, in a new folder."""
    source, out = captures / case.capture, folder / case.name
    out.mkdir(parents=True)
    edited = {one.camera for one in case.videos}
    for file in source.iterdir():
        if file.is_file() and file.stem not in edited and file.suffix in (".mp4", ".json"):
            shutil.copyfile(file, out / file.name)
    rig = json.loads((source / "rig.json").read_text())
    if case.rig is not None:
        case.rig(rig["cameras"])
    (out / "rig.json").write_text(json.dumps(rig))
    for one in case.videos:
        origin = captures / (case.from_capture or case.capture) / f"{one.camera}.mp4"
        if one.edit is unchanged:
            shutil.copyfile(origin, out / origin.name)
            continue
        _encode(out / f"{one.camera}.mp4", one.edit(_pictures(origin)), one.fps_hz)
    return out


def _pictures(path: Path) -> list[Bytes]:
    capture = cv2.VideoCapture(str(path))
    out: list[Bytes] = []
    while True:
        there, pixels = capture.read()
        if not there:
            return out
        out.append(np.asarray(pixels, np.uint8))


def _encode(path: Path, pictures: Iterable[Bytes], fps_hz: float) -> None:
    writer = None
    for one in pictures:
        if writer is None:
            size = (one.shape[1], one.shape[0])
            writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"mp4v"), fps_hz, size)
        writer.write(np.ascontiguousarray(one))
    assert writer is not None
    writer.release()


def late(frames: int) -> Callable[[Pictures], Iterable[Bytes]]:
    """The recording began so many frames later."""
    return lambda pictures: pictures[frames:]


def without(first: int, count: int) -> Callable[[Pictures], Iterable[Bytes]]:
    """So many frames were dropped, and nothing tells."""
    return lambda pictures: [*pictures[:first], *pictures[first + count :]]


def at_rate(fps_hz: float) -> Callable[[Pictures], Iterable[Bytes]]:
    """Another rate, by the nearest pictures of 30 Hz."""
    return lambda p: [
        p[min(len(p) - 1, round(k * 30.0 / fps_hz))] for k in range(int(len(p) * fps_hz / 30.0))
    ]


def flipped(how: int) -> Callable[[Pictures], Iterable[Bytes]]:
    """By cv2.flip: 1 mirrors, -1 turns by 180 degrees."""
    return lambda pictures: (np.asarray(cv2.flip(one, how), np.uint8) for one in pictures)


def cropped(factor: float, x: float = 0.5, y: float = 0.5) -> Callable[[Pictures], Iterable[Bytes]]:
    """A part of the picture, as large as the whole was; x, y: where it is, 0 left and above."""

    def part(one: Bytes) -> Bytes:
        h, w = one.shape[:2]
        cut_w, cut_h = round(w / factor), round(h / factor)
        left, top = round(x * (w - cut_w)), round(y * (h - cut_h))
        cut = one[top : top + cut_h, left : left + cut_w]
        return np.asarray(cv2.resize(cut, (w, h), interpolation=cv2.INTER_LINEAR), np.uint8)

    return lambda pictures: (part(one) for one in pictures)


def letterboxed(factor: float) -> Callable[[Pictures], Iterable[Bytes]]:
    """The whole picture, smaller, with black about it."""

    def boxed(one: Bytes) -> Bytes:
        h, w = one.shape[:2]
        small = cv2.resize(
            one, (round(w * factor), round(h * factor)), interpolation=cv2.INTER_AREA
        )
        out = np.zeros_like(one)
        top, left = (h - small.shape[0]) // 2, (w - small.shape[1]) // 2
        out[top : top + small.shape[0], left : left + small.shape[1]] = small
        return out

    return lambda pictures: (boxed(one) for one in pictures)


def unchanged(pictures: Pictures) -> Iterable[Bytes]:
    """As they are: the file is copied."""
    return pictures


def exchange(a: int, b: int) -> EditRig:
    """The files of two cameras are exchanged."""

    def edit(cameras: Cameras) -> None:
        cameras[a]["file"], cameras[b]["file"] = cameras[b]["file"], cameras[a]["file"]

    return edit


def in_unit(per_metre: float) -> EditRig:
    """t in another unit."""

    def edit(cameras: Cameras) -> None:
        for one in cameras:
            one["t"] = [per_metre * value for value in one["t"]]

    return edit


def other_axes(world: Sequence[Sequence[float]], camera: Sequence[float] = (1, 1, 1)) -> EditRig:
    """world (3,3): old world axes from new ones; camera: signs of the cameras' own axes."""

    def edit(cameras: Cameras) -> None:
        M, D = np.array(world, float), np.diag(np.array(camera, float))
        for one in cameras:
            one["R"] = (D @ np.array(one["R"]) @ M).tolist()
            one["t"] = (D @ np.array(one["t"])).tolist()

    return edit


def inverted(cameras: Cameras) -> None:
    """Camera-to-world in place of world-to-camera."""
    for one in cameras:
        R, t = np.array(one["R"]), np.array(one["t"])
        one["R"], one["t"] = R.T.tolist(), (-R.T @ t).tolist()


_Z_UP = ((1, 0, 0), (0, 0, 1), (0, -1, 0))
_Y_DOWN = ((1, 0, 0), (0, -1, 0), (0, 0, -1))
_Z_BACK = ((1, 0, 0), (0, 1, 0), (0, 0, -1))
_DELAY, _EXCHANGED = str(Mistake.DELAY), str(Mistake.EXCHANGED)
_MIRRORED, _TURNED, _ZOOMED = str(Mistake.MIRRORED), str(Mistake.TURNED), str(Mistake.ZOOMED)
_AXES, _INVERTED, _UNIT = str(Mistake.AXES), str(Mistake.INVERTED), str(Mistake.UNIT)
_OTHER = str(Mistake.CONTRADICTION)
_RATE, _REFUSED = "rate", "refused"


def _delayed(capture: str, camera: str, frames: int) -> WrongCapture:
    name = f"{frames} frame{'s' * (frames > 1)} late, {capture}"
    return WrongCapture(name, capture, (_DELAY,), videos=(EditVideo(camera, late(frames)),))


CASES = (
    WrongCapture("25 Hz", "pair_office_traffic", (_RATE,), videos=(EditVideo("cam1", at_rate(25.0), 25.0),)),
    WrongCapture("24 Hz", "pair_outdoor_async", (_RATE,), videos=(EditVideo("cam0", at_rate(24.0), 24.0),)),
    WrongCapture("15 Hz", "stereo_plain_jog", (_RATE,), videos=(EditVideo("cam0", at_rate(15.0), 15.0),)),
    WrongCapture("24 Hz that say 30", "ring4_plain_kick", (_DELAY,), videos=(EditVideo("cam2", at_rate(24.0)),)),
    WrongCapture("10 frames dropped", "pair_clutter_jacks", (_DELAY,), videos=(EditVideo("cam1", without(110, 10)),)),
    WrongCapture("5 frames dropped", "stereo_plain_armleg", (_DELAY,), videos=(EditVideo("cam0", without(140, 5)),)),
    _delayed("pair_office_traffic", "cam1", 1),
    _delayed("pair_clutter_jacks", "cam0", 2),
    _delayed("pair_lampoff_basket", "cam1", 3),
    _delayed("pair_clutter_martial", "cam1", 4),
    _delayed("pair_outdoor_async", "cam1", 5),
    _delayed("ring4_plain_kick", "cam2", 6),
    _delayed("ring4_plain_squat", "cam1", 7),
    _delayed("ring4_shirt_soccer", "cam3", 8),
    _delayed("stereo_striped_squat", "cam1", 9),
    _delayed("ring4_striped_throw", "cam0", 10),
    _delayed("stereo_shirt_grab", "cam0", 2),
    WrongCapture("exchanged", "pair_office_traffic", (_EXCHANGED,), exchange(0, 1)),
    WrongCapture("exchanged", "stereo_plain_jog", (_EXCHANGED,), exchange(0, 1)),
    WrongCapture("exchanged", "ring4_shirt_soccer", (_EXCHANGED,), exchange(1, 3)),
    WrongCapture("exchanged", "ring4_plain_kick", (_EXCHANGED,), exchange(0, 2)),
    WrongCapture("millimetres", "pair_outdoor_async", (_REFUSED,), in_unit(1000.0)),
    WrongCapture("centimetres", "mono_shirt_signals", (_REFUSED,), in_unit(100.0)),
    WrongCapture("feet", "ring4_shirt_soccer", (_UNIT,), in_unit(1.0 / 0.3048)),
    WrongCapture("z up", "pair_clutter_jacks", (_AXES,), other_axes(_Z_UP)),
    WrongCapture("y down", "ring4_striped_throw", (_AXES,), other_axes(_Y_DOWN)),
    WrongCapture("left-handed", "ring4_plain_squat", (_AXES,), other_axes(_Z_BACK, (1, 1, -1))),
    WrongCapture("left-handed world", "pair_office_traffic", (_REFUSED,), other_axes(_Z_BACK)),
    WrongCapture("OpenGL cameras", "stereo_plain_armleg", (_AXES,), other_axes(np.eye(3).tolist(), (1, -1, -1))),
    WrongCapture("camera-to-world", "pair_office_traffic", (_INVERTED,), inverted),
    WrongCapture("camera-to-world", "ring4_plain_kick", (_INVERTED,), inverted),
    WrongCapture("mirrored", "pair_office_traffic", (_MIRRORED,), videos=(EditVideo("cam1", flipped(1)),)),
    WrongCapture("mirrored", "stereo_plain_armleg", (_MIRRORED,), videos=(EditVideo("cam0", flipped(1)),)),
    WrongCapture("mirrored", "ring4_shirt_soccer", (_MIRRORED,), videos=(EditVideo("cam2", flipped(1)),)),
    WrongCapture("turned 180", "pair_lampoff_basket", (_TURNED,), videos=(EditVideo("cam1", flipped(-1)),)),
    WrongCapture("turned 180", "mono_shirt_signals", (_TURNED,), videos=(EditVideo("cam0", flipped(-1)),)),
    WrongCapture("cropped 1.33", "ring4_shirt_soccer", (_ZOOMED,), videos=(EditVideo("cam2", cropped(1.33)),)),
    WrongCapture("cropped aside", "pair_clutter_jacks", (_ZOOMED,), videos=(EditVideo("cam0", cropped(1.25, 0.2, 0.3)),)),
    WrongCapture("zoomed 1.2", "pair_outdoor_async", (_ZOOMED,), videos=(EditVideo("cam1", cropped(1.2)),)),
    WrongCapture("letterboxed", "stereo_plain_jog", (_ZOOMED,), videos=(EditVideo("cam1", letterboxed(0.75)),)),
    WrongCapture(
        "of another room", "pair_office_traffic", (_OTHER,),
        videos=(EditVideo("cam1", unchanged),), from_capture="pair_clutter_jacks",
    ),
)  # fmt: skip
