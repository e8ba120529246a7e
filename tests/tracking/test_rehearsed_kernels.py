"""Nothing is compiled or loaded while somebody is tracked: a stall of a second, at the first step of a planted foot."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.conftest import ROOT

pytestmark = pytest.mark.kernels

LOADED = """\
import sys
from numba.core.dispatcher import Dispatcher

def loaded():
    modules = [m for name, m in list(sys.modules.items()) if name.startswith("mocapd.")]
    kernels = {v for m in modules for v in vars(m).values() if isinstance(v, Dispatcher)}
    return {f"{k.__module__}.{k.__name__}{types}" for k in kernels for types in k.signatures}

"""
WITH_SHIRT = """\
from pathlib import Path
from mocapd.pipeline.rehearsal import rehearse
from mocapd.sim.setup import setup_of
from mocapd.tracking.tracker_inputs import wearer_shape
from tests.conftest import kept_database
from tests.sim.simulated_calibration import calibration_of_setup
from tests.tracking.profiles import auto_tracker
from tests.tracking.shirt_film import film
from tests.tracking.stepping import Stepping

filmed = film(stands=True, count=30)
known = calibration_of_setup(setup_of(filmed.scenario, filmed.renderers))
tracker = auto_tracker(known, kept_database(Path(sys.argv[1]), count=3000, cells=32))
pictures = {name: one.pixels for name, one in known.shirt.white_balance.items()}
rehearse(tracker, wearer_shape(known), known.rig, pictures, lambda *_: None)
before, stepping = loaded(), Stepping(tracker, wearer_shape(known))
for one in filmed.frame_sets(filmed.pictures):
    track = stepping.step(one)
print(track.body.tracker, *sorted(loaded() - before), sep="\\n")
"""


# without a picture of the person, whom the start may not know, and with what only three cameras and more need
ALL_AROUND = """\
from mocapd.tracking.cues.clothes.clothes_cue import ClothesCue
from mocapd.types import Rig
from tests.vision.hull.ring_of_cameras import ring

ClothesCue(Rig(tuple(ring(4))), 1.75).rehearse()
print(*loaded(), sep="\\n")
"""


def printed(program: str, cache_home: Path) -> list[str]:
    command = [sys.executable, "-c", LOADED + program, str(cache_home)]
    out = subprocess.run(command, check=True, cwd=ROOT, capture_output=True, text=True).stdout
    return out.split("\n")[:-1]


def test_what_tracking_needs_is_loaded_before(cache_home: Path) -> None:
    assert printed(WITH_SHIRT, cache_home) == ["shirt+clothes"]


def test_so_is_what_the_first_person_before_cameras_all_around_needs(cache_home: Path) -> None:
    names = {line.partition("(")[0].rpartition(".")[2] for line in printed(ALL_AROUND, cache_home)}
    assert {"sum_at_points", "joint_jacobian", "place_variances", "add_unmodelled_turns"} <= names
