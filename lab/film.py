"""The README's film, from the simulator: somebody in plain clothes, then in the shirt, with skeleton and avatar.

    python -m lab.film docs/images/film.webp            # renders, tracks with `mocapd track`, draws
    python -m lab.film OUT.webp --frames FOLDER         # of pictures that are there: those of goalkeeper.app.film

The simulated webcams and the tracker are those of the tests: nothing in it is drawn by hand but the avatar.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import cv2
import msgspec
import numpy as np

from lab.simulated.export import export_capture
from mocapd.assets import asset_path
from mocapd.body.bones import PARENT_OF
from mocapd.geometry.camera_model import project
from mocapd.geometry.rig_file import load_rig
from mocapd.sim.scenario import Scenario, load_scenario
from mocapd.types import Bytes, Camera, Floats

SECONDS, EVERY, FPS_HZ = 8.0, 3, 30.0
SKIPPED_S = 1.6  # the empty room, and until somebody is found
WIDTH_PX, HEIGHT_PX, CAPTION_PX = 300, 225, 26
QUALITY = 42
_BONE_BGR, _INK, _PAPER = (255, 216, 79), (35, 32, 29), (247, 250, 251)
_RADII_M = {"Arm": 0.045, "Hand": 0.04, "Leg": 0.065, "Foot": 0.05, "Toes": 0.04, "Shoulder": 0.05}
_AVATAR_BGR = {"left": (178, 120, 40), "right": (60, 120, 220), "": (110, 95, 18)}
SCENES = (("In any clothes", "plain", "markerless"), ("In the shirt", "shirt", "auto"))


def scene(kind: str) -> Scenario:
    """The living room, the whole body in both pictures; kind: `plain` or `shirt`."""
    room = load_scenario(asset_path("scenarios") / "jacket.toml")
    clothes = msgspec.structs.replace(room.clothes, events=(), jacket=None)
    if kind == "plain":
        clothes = msgspec.structs.replace(clothes, shirt="plain")
    return msgspec.structs.replace(room, name=f"film-{kind}", clothes=clothes)


def tracked(capture: Path, tracker: str) -> tuple[Floats, Floats, tuple[str, ...]]:
    """times_s (F,), joints_m (F,J,3) and the joints' names, by `mocapd track`."""
    out = capture.with_suffix(".npz")
    command = [sys.executable, "-m", "mocapd.cli.main", "track", str(capture), "--out", str(out)]
    subprocess.run([*command, "--tracker", tracker], check=True, env=dict(os.environ))
    with np.load(out) as track:
        names = tuple(str(name) for name in track["joint_names"])
        return track["times"], track["joints"], names


def frames_of(kind: str, caption: str, tracker: str, folder: Path) -> list[Bytes]:
    """Of one scene: both pictures with the skeleton, and the avatar."""
    capture = folder / f"film-{kind}"
    export_capture(scene(kind), capture, SECONDS)
    times_s, joints_m, names = tracked(capture, tracker)
    rig, out = load_rig(capture / "rig.json"), []
    films = _films(capture, len(rig.cameras))
    for number in range(round(SKIPPED_S * FPS_HZ), round(SECONDS * FPS_HZ), EVERY):
        nearest = int(np.abs(times_s - number / FPS_HZ).argmin())
        found = abs(times_s[nearest] - number / FPS_HZ) < 0.6 / FPS_HZ
        body_m = joints_m[nearest] if found else None
        pictures = [
            _picture(film[number], camera, body_m, names)
            for film, camera in zip(films, rig.cameras, strict=True)
        ]
        out.append(_row([*pictures, avatar(body_m, names)], caption))
    return out


def _films(capture: Path, cameras: int) -> list[list[Bytes]]:
    """The pictures of each camera's video."""
    films = []
    for k in range(cameras):
        video, pictures = cv2.VideoCapture(str(capture / f"cam{k}.mp4")), []
        while (read := video.read())[0]:
            pictures.append(np.asarray(read[1], dtype=np.uint8))
        films.append(pictures)
    return films


def _picture(pixels: Bytes, camera: Camera, body_m: Floats | None, names: tuple[str, ...]) -> Bytes:
    for a_m, b_m in () if body_m is None else _bones(body_m, names):
        ends = np.rint(project(camera, np.stack([a_m, b_m])))
        if np.isfinite(ends).all():
            a, b = ends.astype(int).tolist()
            cv2.line(pixels, a, b, (0, 0, 0), 7, cv2.LINE_AA)
            cv2.line(pixels, a, b, _BONE_BGR, 4, cv2.LINE_AA)
    size = WIDTH_PX, HEIGHT_PX
    return np.asarray(cv2.resize(pixels, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)


def _bones(body_m: Floats, names: tuple[str, ...]) -> list[tuple[Floats, Floats]]:
    return [
        (body_m[names.index(parent)], body_m[child])
        for child, name in enumerate(names)
        if (parent := PARENT_OF.get(name, "")) in names
    ]


def avatar(body_m: Floats | None, names: tuple[str, ...]) -> Bytes:
    """The body as capsules, from the front, on a floor with a grid of half metres."""
    canvas = np.full((2 * HEIGHT_PX, 2 * WIDTH_PX, 3), _PAPER[::-1], np.uint8)
    for metres in np.arange(-2.0, 2.01, 0.5):
        for ends_m in ([[metres, 0, -2], [metres, 0, 2]], [[-2, 0, metres], [2, 0, metres]]):
            a, b = (_seen(np.array(end))[:2] for end in ends_m)
            cv2.line(canvas, _pixel(a), _pixel(b), (206, 208, 201), 2, cv2.LINE_AA)
    if body_m is not None:
        _draw_body(canvas, body_m, names)
    small = cv2.resize(canvas, (WIDTH_PX, HEIGHT_PX), interpolation=cv2.INTER_AREA)
    return np.asarray(small, dtype=np.uint8)


def _draw_body(canvas: Bytes, body_m: Floats, names: tuple[str, ...]) -> None:
    parts = []
    for child, name in enumerate(names):
        parent = PARENT_OF.get(name, "")
        if parent not in names:
            continue
        radius_m = next((r for key, r in _RADII_M.items() if key in name), 0.085)
        parts.append((name, body_m[names.index(parent)], body_m[child], radius_m))
    head_m = body_m[names.index("head")]
    parts.append(("head", head_m + [0, 0.05, 0], head_m + [0, 0.13, 0], 0.10))
    for name, a_m, b_m, radius_m in sorted(parts, key=lambda part: float(part[1][2] + part[2][2])):
        side = next((one for one in ("left", "right") if name.startswith(one)), "")
        (ax, ay, scale), (bx, by, _) = _seen(a_m), _seen(b_m)
        colour = np.array(_AVATAR_BGR[side], dtype=float)
        for shade, width, up in ((0.55, 2.0, 0.0), (1.0, 1.7, 0.0), (1.35, 0.7, 0.35)):
            thick = max(2, round(width * radius_m * scale))
            bgr = np.clip(shade * colour, 0, 255).tolist()
            off = np.array([0.0, -up * radius_m * scale])
            a, b = _pixel(np.array([ax, ay]) + off), _pixel(np.array([bx, by]) + off)
            cv2.line(canvas, a, b, bgr, thick, cv2.LINE_AA)


def _seen(point_m: Floats) -> Floats:
    """x, y [px] on the avatar's canvas and px a metre, from 4.2 m before it and 1.5 m high."""
    depth_m = max(0.2, 4.2 - point_m[2])
    scale = 1.5 * 2 * HEIGHT_PX / depth_m
    x, y = WIDTH_PX + point_m[0] * scale, 0.42 * 2 * HEIGHT_PX - (point_m[1] - 1.2) * scale
    return np.array([x, y, scale])


def _pixel(at: Floats) -> tuple[int, int]:
    return int(np.clip(at[0], -4000, 4000)), int(np.clip(at[1], -4000, 4000))


def _row(pictures: Sequence[Bytes], caption: str) -> Bytes:
    row = np.hstack(list(pictures))
    bar = np.full((CAPTION_PX, row.shape[1], 3), _PAPER[::-1], np.uint8)
    texts = [(f"{caption}: webcam 1", 0), ("webcam 2", 1), ("an avatar from the pose", 2)]
    for text, column in texts:
        at = column * WIDTH_PX + 8, CAPTION_PX - 8
        cv2.putText(bar, text, at, cv2.FONT_HERSHEY_SIMPLEX, 0.5, _INK, 1, cv2.LINE_AA)
    return np.asarray(np.vstack([bar, row]), dtype=np.uint8)


def write_webp(path: Path, frames: Sequence[Bytes], rate_hz: float, quality: int) -> None:
    """An animated WebP that repeats for ever."""
    film = cv2.Animation()
    film.frames = list(frames)
    film.durations = [round(1000.0 / rate_hz)] * len(frames)
    if not cv2.imwriteanimation(str(path), film, [cv2.IMWRITE_WEBP_QUALITY, quality]):
        raise SystemExit(f"{path} cannot be written")
    seconds = len(frames) / rate_hz
    size_mb = path.stat().st_size / 1e6
    sys.stdout.write(f"{path}: {len(frames)} frames, {seconds:.1f} s, {size_mb:.2f} MB\n")


def main(arguments: list[str] | None = None) -> None:
    """See the module's docstring."""
    parser = argparse.ArgumentParser(description="makes an animated WebP")
    parser.add_argument("out", type=Path)
    parser.add_argument(
        "--frames", type=Path, help="a folder of pictures, in the order of their names"
    )
    parser.add_argument("--rate", type=float, default=FPS_HZ / EVERY, help="of these [Hz]")
    parser.add_argument("--quality", type=int, default=QUALITY)
    options = parser.parse_args(arguments)
    if options.frames is not None:
        paths = sorted(options.frames.glob("*.png"))
        frames = [np.asarray(cv2.imread(str(path)), dtype=np.uint8) for path in paths]
    else:
        with tempfile.TemporaryDirectory(prefix="mocapd-film-") as folder:
            frames = [
                frame
                for caption, kind, tracker in SCENES
                for frame in frames_of(kind, caption, tracker, Path(folder))
            ]
    write_webp(options.out, frames, options.rate, options.quality)


if __name__ == "__main__":
    main()
