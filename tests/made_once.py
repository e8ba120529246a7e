"""Makes what many of the processes of `make test` need, before them: kernels, a film, and the pose database.

Four that begin at the same moment would otherwise compile the same, each for itself, as they would read all tests for
the first time. Four processes share the work; what is there already is left as it is.
"""

import subprocess
import sys
from collections.abc import Callable, Mapping

from mocapd.app.libraries import prepare_libraries
from mocapd.assets import asset_path
from mocapd.calibration.calibration_record import Calibration
from mocapd.config.sections import CameraSection, Config, TrackerSection
from mocapd.session.prepared_marker import remember
from mocapd.session.tracker_setup import cache_resources, make_caches, ready_tracker
from mocapd.sim.film import load_film
from mocapd.sim.scenario import load_scenario
from mocapd.tracking.base import Tracker
from mocapd.tracking.tracker_inputs import wearer_shape
from tests.conftest import ROOT
from tests.sim.simulated_calibration import calibration_of_setup
from tests.tracking.hard_film import CLOSE_PAIR, N_EMPTY, HardFilm, hard_film
from tests.tracking.plain_film import PlainFilm, plain_film
from tests.tracking.profiles import hecht2009_tracker, markerless_tracker, rao_hodges_tracker
from tests.tracking.stepping import Stepping

_CONFIRMED = 25  # frames
CACHE = ROOT / ".pytest_cache" / "d" / "mocapd" / "mocapd"  # in the fixture cache_home


def _quiet(*_: object) -> None:
    """Progress that nobody looks at."""


def _room() -> Calibration:
    """Of the film of the setup's page, on which the daemons of tests/faults run too."""
    scenario = load_scenario(asset_path("scenarios/first_setup.toml"))
    return calibration_of_setup(load_film(scenario, CACHE).setup)


def _compile(tracker: str) -> None:
    """As a daemon does before it is live."""
    ready_tracker(tracker, _room(), cache_resources(CACHE, _quiet), _quiet)


def _follow(film: HardFilm | PlainFilm, build: Callable[[Calibration], Tracker]) -> None:
    """Whoever comes is found, believed and followed."""
    tracker = Stepping(build(film.known), wearer_shape(film.known))
    for one in film.frames[: N_EMPTY + _CONFIRMED]:
        tracker.step(one)


def film_and_markerless() -> None:
    """The renderer's kernels, the film, and the kernels of the tracker without a shirt, also of two cameras side by side."""
    _compile("markerless")
    _follow(hard_film(CLOSE_PAIR), markerless_tracker)


def database_and_shirt() -> None:
    """The pose database, and the kernels of the tracker with the shirt; it waits for the film."""
    make_caches("shirt", CACHE, _quiet)
    _compile("shirt")


def published_trackers() -> None:
    """Kernels of the published trackers; wang2011 waits for the film, too.

    Most of the others' compile when somebody is found, who stands too far away in the setup's film.
    """
    _follow(hard_film("before_a_television"), hecht2009_tracker)
    _follow(plain_film(has_third=True), rao_hodges_tracker)
    _compile("wang2011")


PARTS: Mapping[str, Callable[[], None]] = {
    one.__name__: one for one in (film_and_markerless, database_and_shirt, published_trackers)
}


def main(words: list[str]) -> int:
    """The named part, or all at once; the exit code."""
    if words:
        prepare_libraries(CACHE)
        PARTS[words[0]]()
        return 0
    made = [subprocess.Popen([sys.executable, "-m", "tests.made_once", name]) for name in PARTS]
    reading = _read_tests()
    code = max([abs(one.wait()) for one in made])
    if reading is not None:
        reading.wait()  # a test that cannot be read says so itself
    if code == 0:
        _remember()
    return code


def _read_tests() -> subprocess.Popen[bytes] | None:
    """Python's code of the tests, with what pytest adds to their assertions, where it is not there yet."""
    if any((ROOT / "tests" / "__pycache__").glob("*-pytest-*.pyc")):
        return None
    collect = [sys.executable, "-m", "pytest", "--collect-only", "-q", "--ignore", "tests/clients"]
    return subprocess.Popen(collect, stdout=subprocess.DEVNULL)


def _remember() -> None:
    """So that no daemon of a test takes its start for the first one, whose stream begins with a part of the tracker."""
    for name in ("auto", "shirt", "markerless"):
        for source in ("sim:living_room#cam0", "/dev/video0"):
            camera = (CameraSection("cam0", source),)
            remember(Config(cache_dir=CACHE, camera=camera, tracker=TrackerSection(name)))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
