"""Rig files, calibration.toml with its pictures, and the file of lenses."""

import os
from datetime import UTC, datetime
from random import Random

from mocapd.calibration.calibration_file import load_calibration, read_calibration
from mocapd.calibration.calibration_writing import COLOURS
from mocapd.geometry.rig_file import load_rig
from mocapd.wizard.intrinsics.saved_intrinsics import FILE_NAME as LENSES
from mocapd.wizard.intrinsics.saved_intrinsics import (
    find_saved_intrinsics,
    read_intrinsics,
    store_intrinsics,
)
from mocapd.wizard.saving import load_draft, save_draft
from tests.capture.films import write_capture
from tests.fuzz.damaged_pictures import damaged_png
from tests.fuzz.mutations import JSON_VALUES, TOML_LINES, TOML_VALUES, mistyped
from tests.fuzz.row import Attempt, Place, taken
from tests.wizard.drafts import full_draft


def rigs(place: Place) -> Attempt:
    """rig.json of a capture."""
    path = write_capture(place.folder / "capture", frames=(1, 1)) / "rig.json"
    good = path.read_bytes()
    load_rig(path)

    def attempt(random: Random, number: int) -> bool:
        path.write_bytes(mistyped(random, good, JSON_VALUES))
        return taken(lambda: load_rig(path))

    return attempt


def calibrations(place: Place) -> Attempt:
    """calibration.toml as `mocapd run` and the setup read it."""
    path = save_draft(full_draft(), place.folder)
    good = path.read_bytes()
    for folder in (place.folder, place.folder / COLOURS):
        os.mkfifo(folder / "fifo")  # one of the nasty names
    load_draft(path)

    def attempt(random: Random, number: int) -> bool:
        path.write_bytes(mistyped(random, good, TOML_VALUES, TOML_LINES))
        read_calibration(path)
        load_calibration(path)
        return taken(lambda: load_draft(path))

    return attempt


def pictures(place: Place) -> Attempt:
    """The picture and the strokes that a calibration names."""
    path = save_draft(full_draft(), place.folder)
    files = {one: one.read_bytes() for one in sorted((place.folder / COLOURS).iterdir())}
    load_calibration(path)

    def attempt(random: Random, number: int) -> bool:
        one = random.choice(tuple(files))
        one.write_bytes(damaged_png(random, files[one]))
        try:
            return taken(lambda: load_calibration(path))
        finally:
            one.write_bytes(files[one])

    return attempt


def lenses(place: Place) -> Attempt:
    """lenses.toml."""
    draft = full_draft()
    store_intrinsics(draft, place.folder, datetime(2026, 11, 22, tzinfo=UTC))
    path = place.folder / LENSES
    good = path.read_bytes()
    assert find_saved_intrinsics(draft.cameras[0], read_intrinsics(place.folder)) is not None

    def attempt(random: Random, number: int) -> bool:
        path.write_bytes(mistyped(random, good, TOML_VALUES, TOML_LINES))
        for camera in draft.cameras:
            found = find_saved_intrinsics(camera, read_intrinsics(place.folder))
            if found is not None:
                found.intrinsics()
        return True

    return attempt
