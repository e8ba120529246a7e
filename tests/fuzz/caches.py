"""What is kept and made again: films, the pose database, the list of what was prepared."""

from collections.abc import Mapping
from random import Random
from unittest.mock import patch

import numpy as np

from mocapd.app.daemon.cache_warmup import prepare_in_processes
from mocapd.config.sections import Config
from mocapd.session.prepared_marker import MARKER
from mocapd.shirt.pose_database import database_file
from mocapd.shirt.pose_database.cache_name import CACHE_NAME
from mocapd.shirt.pose_database.database import DatabaseParams, PoseDatabase, content_hash
from mocapd.shirt.pose_database.database_file import load_or_build
from mocapd.sim import film as film_module
from mocapd.sim import renderer as renderer_module
from mocapd.sim.film import Film, film_key, load_film
from mocapd.sim.scenario import scenario_from_dict
from tests.fuzz.mutations import damaged
from tests.fuzz.row import Attempt, Place, WrongError
from tests.sim.small import TABLE, table

_DATABASE = DatabaseParams(count=60, cells=4, dimensions=8)


class _MadeAnew(Exception):
    """Instead of making it, which takes seconds."""


def _anew(*_args: object, **_kwargs: object) -> None:
    raise _MadeAnew


def films(place: Place) -> Attempt:
    """A damaged film is made anew, whatever byte it is that changed."""
    camera = {**TABLE["cameras"][0], "size_px": [16, 16]}
    motion = {"keyframes": [{"t_s": 0.0, "pose": "t_pose"}]}
    scenario = scenario_from_dict(
        table(cameras=[camera], fps_hz=10.0, loop_s=0.3, motion=motion, lights=[], room={})
    )
    good = load_film(scenario, place.cache)
    key = film_key(scenario)  # of code and scenario, which stay
    # films of other code may lie there too
    (kept,) = place.cache.glob(f"*{key[:16]}.film")
    data, path = kept.read_bytes(), place.folder / kept.name
    wanted = _shown(good)

    def attempt(random: Random, number: int) -> bool:
        changed = damaged(random, data)
        path.write_bytes(changed)
        with (
            patch.object(film_module, "film_key", lambda _: key),
            patch.object(renderer_module, "camera_renderers", _anew),
        ):
            try:
                found = load_film(scenario, place.folder)
            except _MadeAnew:
                return False
        _must_be_equal(_shown(found), wanted, "a film whose file was damaged shows something else")
        return True

    return attempt


def _shown(film: Film) -> dict[str, object]:
    """All that a film shows, by name."""
    pictures = {f"scribble {name}": one for name, one in film.setup.scribbles.items()}
    pictures |= {f"model {number}": one for number, one in enumerate(film.setup.model)}
    shown: dict[str, object] = {"first": film.first, **film.frames}
    for name, one in pictures.items():
        shown |= {name: one.pixels, f"{name} strokes": one.labels}
    return shown


def databases(place: Place) -> Attempt:
    """The same of the pose database."""
    kept = place.cache / "database"
    good = load_or_build(kept, _DATABASE).database
    data, path = (kept / CACHE_NAME).read_bytes(), place.folder / CACHE_NAME
    wanted = _arrays(good)
    digest = content_hash(_DATABASE)  # of code and body, which stay

    def attempt(random: Random, number: int) -> bool:
        # half of them in the header, which is a thousandth of the file
        head = 2048 if number % 2 else len(data)
        path.write_bytes(damaged(random, data[:head]) + data[head:])
        with (
            patch.object(database_file, "content_hash", lambda _: digest),
            patch.object(database_file, "build_database", _anew),
        ):
            try:
                found = load_or_build(place.folder, _DATABASE).database
            except _MadeAnew:
                return False
        _must_be_equal(_arrays(found), wanted, "a database whose file was damaged is another")
        return True

    return attempt


def _arrays(database: PoseDatabase) -> dict[str, object]:
    index = database.index
    return {
        "local": database.local_xyzw,
        "root": database.camera_from_root_xyzw,
        "root_m": database.root_m,
        "side": database.side_rad,
        "mean": index.projection.mean,
        "basis": index.projection.basis,
        "centres": index.centres,
        "start": index.start,
        "vectors": index.vectors,
        "maps": index.packed_maps,
    }


def _must_be_equal(found: Mapping[str, object], wanted: Mapping[str, object], what: str) -> None:
    """Raises WrongError."""
    same = found.keys() == wanted.keys() and all(
        np.array_equal(np.asarray(found[name]), np.asarray(one)) for name, one in wanted.items()
    )
    if not same:
        raise WrongError(what)


def markers(place: Place) -> Attempt:
    """The list of what was prepared: what it says is believed or not, and no trouble."""
    config = Config(cache_dir=place.folder, state_dir=place.folder / "state")
    path = place.folder / MARKER
    good = b"".join(b"%064x\n" % (1 << 200 | n) for n in range(4))
    path.write_bytes(good)
    prepare_in_processes(config)  # without a camera, so that its processes end at once

    def attempt(random: Random, number: int) -> bool:
        path.write_bytes(damaged(random, good))
        prepare_in_processes(config)
        return True

    return attempt
