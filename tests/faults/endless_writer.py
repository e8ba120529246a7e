"""Writes one kind of file over and over, and says the number of each once it is written, until it is killed.

python -m tests.faults.endless_writer calibration|cache FOLDER FIRST
"""

import sys
from collections.abc import Callable
from dataclasses import replace
from itertools import count
from pathlib import Path

import msgspec
import numpy as np
import platformdirs

from mocapd.calibration.calibration_file import FILE_NAME, read_calibration
from mocapd.errors import InputError
from mocapd.sim.cache_file import read_cached, write_cached
from mocapd.sim.film import load_film
from mocapd.types import LabelledPicture
from mocapd.wizard.draft import Draft, DraftCamera, DraftColours, ExtrinsicsQuality
from mocapd.wizard.saving import load_draft, save_draft
from tests.sim import small

_CACHE_KEY = "endless"
_CACHE_BYTES = 4 << 20
_PER_M = 100_000  # the number is kept in the stature


class CachedNumber(msgspec.Struct, frozen=True):
    """A large file that says its number from the first byte to the last."""

    key: str
    numbers: bytes


def draft_of_small() -> Draft:
    """What a setup of the small scenario would save."""
    scenario = small.scenario()
    setup = load_film(scenario, platformdirs.user_cache_path("mocapd")).setup
    cameras = tuple(
        DraftCamera(one.name, f"sim:small#{one.name}", one.size_px, scenario.fps_hz)
        for one in setup.rig.cameras
    )
    quality = ExtrinsicsQuality("board", 0.2, {one.id: 0.2 for one in cameras}, 0.5)
    return Draft(
        cameras=cameras,
        rig=setup.rig,
        extrinsics_quality=quality,
        floor_known=True,
        colours={name: DraftColours(one, np.eye(3)) for name, one in setup.scribbles.items()},
        stature_m=1.75,
    )


def save_calibration(folder: Path, draft: Draft, number: int) -> None:
    """With pictures of its own, which are files beside it."""
    colours = {}
    for name, one in draft.colours.items():
        pixels = one.picture.pixels.copy()
        pixels[0, 0] = number & 0xFF, number >> 8 & 0xFF, number >> 16 & 0xFF
        colours[name] = DraftColours(LabelledPicture(pixels, one.picture.labels), one.W)
    stature_m = 1.0 + number / _PER_M
    save_draft(replace(draft, colours=colours, stature_m=stature_m), folder)


def saved_number(folder: Path) -> int | None:
    """Of the calibration that is there, read with its pictures; None for none. Raises what reading raises."""
    if not (folder / FILE_NAME).exists():
        return None
    wearer = read_calibration(folder / FILE_NAME).wearer
    pictures = {one.picture.pixels[0, 0].tobytes() for one in load_draft(folder).colours.values()}
    stature_m = None if wearer is None else wearer.stature_m
    number = 0 if stature_m is None else round((stature_m - 1.0) * _PER_M)
    if pictures != {number.to_bytes(3, "little")}:
        raise InputError(f"the pictures are not those of {number}", str(folder))
    return number


def cached_number(folder: Path) -> int | None:
    """Of the cache file that is there; None where it is not whole, or is none."""
    found = read_cached(folder / "numbers", _CACHE_KEY, CachedNumber)
    return None if found is None else int.from_bytes(found.numbers[:8], "little")


def cache_number(folder: Path, number: int) -> None:
    """As the simulator keeps a film."""
    numbers = number.to_bytes(8, "little") * (_CACHE_BYTES // 8)
    write_cached(folder / "numbers", CachedNumber(_CACHE_KEY, numbers))


def main() -> None:
    """Until it is killed."""
    kind, folder, first = sys.argv[1], Path(sys.argv[2]), int(sys.argv[3])
    write: Callable[[int], None]
    if kind == "calibration":
        draft = draft_of_small()

        def write(number: int) -> None:
            save_calibration(folder, draft, number)
    else:

        def write(number: int) -> None:
            cache_number(folder, number)

    print("begun", flush=True)
    for number in count(first):
        write(number)
        print(number, flush=True)


if __name__ == "__main__":
    main()
