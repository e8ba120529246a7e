"""One loop of a scenario, rendered beforehand to JPEG, so that playing it costs next to nothing.

The renderer is imported when a film is rendered: its kernels take longer to import than a film to read.
"""

import hashlib
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import cv2
import msgspec
import numpy as np

import mocapd.body
import mocapd.sim
from mocapd.assets import asset_path
from mocapd.sim.cache_file import cache_path, read_or_make
from mocapd.sim.scenario import Scenario
from mocapd.sim.setup_record import SimSetup
from mocapd.sim.world import World, rig_of
from mocapd.types import Bytes, LabelledPicture

if TYPE_CHECKING:
    from mocapd.sim.renderer import CameraRenderer

BEGINNING_S = 2.0  # rendered in as much time, on one processor
Progress = Callable[[int, int], None]  # frames done, frames in all


@dataclass(frozen=True, slots=True, eq=False)
class Film:
    """frames[camera]: the JPEG files of one loop; frame i shows world frame first + i, and repeats."""

    scenario: Scenario
    first: int
    frames: Mapping[str, tuple[bytes, ...]]
    setup: SimSetup


class _Pixels(msgspec.Struct, frozen=True):
    """A picture of the set-up and its strokes; as pixels, because a PNG takes 20 ms to check and decode at each start."""

    shape: tuple[int, int]  # rows, columns
    pixels: bytes
    labels: bytes


class _FilmFile(msgspec.Struct, frozen=True):
    """On disk, as msgpack."""

    key: str
    first: int
    frames: dict[str, list[bytes]]
    scribbles: dict[str, _Pixels]
    model: list[_Pixels]


def load_film(scenario: Scenario, cache_dir: Path, progress: Progress | None = None) -> Film:
    """The film of a scenario, from the cache or rendered now (about 20 s for 12 s of two cameras).

    A stale, damaged or incomplete cache file is rendered again. Raises CannotCreateError when the
    cache cannot be written.
    """
    return _load(
        scenario, _file_name(scenario), film_key(scenario), scenario.loop_s, cache_dir, progress
    )


def _load(
    scenario: Scenario,
    name: str,
    key: str,
    length_s: float,
    cache_dir: Path,
    progress: Progress | None,
) -> Film:
    count = round(length_s * scenario.fps_hz)
    stored = read_or_make(
        cache_dir, name, key, _FilmFile, lambda: _render(scenario, key, progress, count)
    )
    return _film(scenario, stored)


def _file_name(scenario: Scenario) -> str:
    return f"sim-{scenario.name}"


def _film(scenario: Scenario, stored: _FilmFile) -> Film:
    setup = SimSetup(
        rig=rig_of(scenario),
        stature_m=scenario.body.stature_m,
        scribbles={name: _labelled(picture) for name, picture in stored.scribbles.items()},
        model=tuple(_labelled(picture) for picture in stored.model),
    )
    frames = {name: tuple(jpegs) for name, jpegs in stored.frames.items()}
    return Film(scenario, stored.first, frames, setup)


def load_beginning(scenario: Scenario, cache_dir: Path, progress: Progress | None = None) -> Film:
    """The first seconds of the film, which are ready sooner. They play forth and back, without a jump. Raises
    CannotCreateError."""
    if is_rendered(scenario, cache_dir):
        return load_film(scenario, cache_dir, progress)
    key, name = film_key(scenario), _file_name(scenario)
    length_s = min(BEGINNING_S, scenario.loop_s)
    film = _load(scenario, f"{name}-beginning", key, length_s, cache_dir, progress)
    return replace(film, frames={name: (*one, *one[-2:0:-1]) for name, one in film.frames.items()})


def is_rendered(scenario: Scenario, cache_dir: Path) -> bool:
    """True if the whole film is in the cache; only loading checks whether it is damaged."""
    return cache_path(cache_dir, _file_name(scenario), film_key(scenario)).exists()


def film_key(scenario: Scenario) -> str:
    """A hash of everything the pictures follow from: the scenario, and the code and assets that draw."""
    digest = hashlib.sha256(msgspec.json.encode(scenario))
    for package in (mocapd.sim, mocapd.body):
        for folder in package.__path__:
            for source in sorted(Path(folder).rglob("*.py")):
                digest.update(source.read_bytes())
    for asset in ("shirt_standard_v1.json", "body_proportions.json"):
        digest.update(asset_path(asset).read_bytes())
    return digest.hexdigest()


def first_frame(scenario: Scenario) -> int:
    """The first world frame in which every camera sees the person."""
    earliest = min(camera.clock_offset_s for camera in scenario.cameras)
    return max(0, int(np.ceil((scenario.person_appears_s - earliest) * scenario.fps_hz - 1e-9)))


def encode_jpeg(pixels: Bytes, quality: int) -> bytes:
    """A JPEG file of pixels (H,W,3) BGR."""
    _, data = cv2.imencode(".jpg", pixels, [cv2.IMWRITE_JPEG_QUALITY, quality])
    return bytes(data)


def _render(scenario: Scenario, key: str, progress: Progress | None, n: int) -> _FilmFile:
    from mocapd.sim.renderer import camera_renderers
    from mocapd.sim.setup import setup_of

    renderers = camera_renderers(World(scenario))
    first = first_frame(scenario)
    frames: dict[str, list[bytes]] = {r.camera.name: [] for r in renderers}
    with ThreadPoolExecutor(len(renderers)) as pool:
        for i in range(n):
            shoot = partial(_shoot, first + i, scenario.jpeg_quality)
            for k, (name, jpeg) in enumerate(zip(frames, pool.map(shoot, renderers), strict=True)):
                frames[name].append(jpeg)
                if progress is not None:
                    progress(i * len(renderers) + k + 1, n * len(renderers))
    setup = setup_of(scenario, renderers)
    return _FilmFile(
        key=key,
        first=first,
        frames=frames,
        scribbles={name: _pixels(image) for name, image in setup.scribbles.items()},
        model=[_pixels(image) for image in setup.model],
    )


def _shoot(frame: int, quality: int, renderer: "CameraRenderer") -> bytes:
    return encode_jpeg(renderer.frame(frame), quality)


def _pixels(image: LabelledPicture) -> _Pixels:
    rows, columns = image.labels.shape
    return _Pixels((rows, columns), image.pixels.tobytes(), image.labels.tobytes())


def _labelled(picture: _Pixels) -> LabelledPicture:
    pixels, labels = (np.frombuffer(data, np.uint8) for data in (picture.pixels, picture.labels))
    # copied, because kernels are compiled for arrays that may be written
    return LabelledPicture(
        pixels.reshape(*picture.shape, 3).copy(), labels.reshape(picture.shape).copy()
    )
