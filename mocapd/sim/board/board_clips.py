"""The board's scenes of a first setup, rendered beforehand as a film is."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from itertools import pairwise
from pathlib import Path

import msgspec

from mocapd.sim.board.board_path import (
    BoardPlace,
    floor_place,
    interpolate,
    lens_places,
    room_places,
)
from mocapd.sim.board.board_shots import BoardShots
from mocapd.sim.cache_file import read_or_make
from mocapd.sim.clips import Clip
from mocapd.sim.film import Progress, encode_jpeg, film_key
from mocapd.sim.renderer import camera_renderers, furnished_set
from mocapd.sim.scenario import Scenario
from mocapd.sim.setup_scenes import SETUP_BOARD, SetupScene
from mocapd.sim.world import World, rig_of
from mocapd.types import Camera

HOLD_S, MOVE_S = 0.7, 0.3  # the board is held still, then moved on
_MOVE_PICTURES = 3
_STILL_PICTURES = 2  # in turn, so that what stands still is as noisy as it is with a webcam


class _BoardFile(msgspec.Struct, frozen=True):
    """On disk, as msgpack: the pictures by scene and camera."""

    key: str
    scenes: dict[str, dict[str, list[bytes]]]


def board_scenes(cameras: Sequence[Camera]) -> dict[SetupScene, list[BoardPlace | None]]:
    """The places at which the board is held, one after the other and over again; None: no board."""
    return {
        SetupScene.EMPTY: [None],
        SetupScene.LENS: [*lens_places(cameras)],
        SetupScene.ROOM: [*room_places(cameras)],
        SetupScene.FLOOR: [floor_place()],
    }


def hold_frames(fps_hz: float) -> tuple[int, int]:
    """For how many frames the board is held still, and for how many moved."""
    moved = max(1, round(MOVE_S * fps_hz / _MOVE_PICTURES)) * _MOVE_PICTURES
    return max(_STILL_PICTURES, round(HOLD_S * fps_hz)), moved


def load_board_clips(
    scenario: Scenario, cache_dir: Path, progress: Progress | None = None
) -> dict[SetupScene, Clip]:
    """The board's scenes, from the cache or rendered now. Raises CannotCreateError when the cache
    cannot be written."""
    key = film_key(scenario)
    stored = read_or_make(
        cache_dir,
        f"setup-{scenario.name}",
        key,
        _BoardFile,
        lambda: _render(scenario, key, progress),
    )
    scenes = board_scenes(rig_of(scenario).cameras)
    return {
        scene: Clip(_order(len(places), scenario.fps_hz), stored.scenes[scene])
        for scene, places in scenes.items()
    }


def _shots(places: Sequence[BoardPlace | None]) -> list[tuple[BoardPlace | None, int]]:
    """Where the board is, and how many pictures are taken: held, each followed by the way to the next."""
    out: list[tuple[BoardPlace | None, int]] = []
    for a, b in pairwise([*places, places[0]]):
        out.append((a, _STILL_PICTURES))
        if a is not None and b is not None and a is not b:
            out += [
                (interpolate(a, b, (k + 0.5) / _MOVE_PICTURES), 1) for k in range(_MOVE_PICTURES)
            ]
    return out


def _order(places: int, fps_hz: float) -> list[int]:
    """Which picture of `_shots` each frame shows."""
    if places == 1:
        return list(range(_STILL_PICTURES))
    held, moved = hold_frames(fps_hz)
    still = [i % _STILL_PICTURES for i in range(held)]
    way = [_STILL_PICTURES + i * _MOVE_PICTURES // moved for i in range(moved)]
    each = _STILL_PICTURES + _MOVE_PICTURES
    return [place * each + i for place in range(places) for i in still + way]


def _render(scenario: Scenario, key: str, progress: Progress | None) -> _BoardFile:
    renderers = camera_renderers(World(scenario))
    lamps = furnished_set(scenario).lamps
    shooters = [BoardShots(renderer, lamps, SETUP_BOARD) for renderer in renderers]
    names = [renderer.camera.name for renderer in renderers]
    scenes = {s: _shots(p) for s, p in board_scenes([r.camera for r in renderers]).items()}
    total = sum(count for shots in scenes.values() for _, count in shots)
    done = 0
    out: dict[str, dict[str, list[bytes]]] = {s: {name: [] for name in names} for s in scenes}
    with ThreadPoolExecutor(len(shooters)) as pool:
        for scene, shots in scenes.items():
            for place, count in shots:
                keys = range(done, done + count)
                shoot = partial(_shoot, place, keys, scenario.jpeg_quality)
                for name, jpegs in zip(names, pool.map(shoot, shooters), strict=True):
                    out[scene][name] += jpegs
                done += count
                if progress is not None:
                    progress(done, total)
    return _BoardFile(key, out)


def _shoot(
    place: BoardPlace | None, noise_keys: range, quality: int, shots: BoardShots
) -> list[bytes]:
    return [encode_jpeg(pixels, quality) for pixels in shots.pictures(place, noise_keys)]
