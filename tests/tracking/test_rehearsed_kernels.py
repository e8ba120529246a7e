"""Nothing is compiled or loaded while somebody is tracked: a stall of a second, at the first step of a planted foot."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.conftest import ROOT

pytestmark = pytest.mark.kernels

PROGRAM = """\
import sys
from pathlib import Path
from numba.core.dispatcher import Dispatcher
from mocapd.pipeline.rehearsal import rehearse
from mocapd.sim.setup import setup_of
from mocapd.tracking.tracker_inputs import wearer_shape
from tests.conftest import kept_database
from tests.sim.simulated_calibration import calibration_of_setup
from tests.tracking.profiles import auto_tracker
from tests.tracking.shirt_film import film
from tests.tracking.stepping import Stepping

def loaded():
    modules = [m for name, m in list(sys.modules.items()) if name.startswith("mocapd.")]
    kernels = {v for m in modules for v in vars(m).values() if isinstance(v, Dispatcher)}
    return {f"{k.__module__}.{k.__name__}{types}" for k in kernels for types in k.signatures}

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


def test_what_tracking_needs_is_loaded_before(cache_home: Path) -> None:
    command = [sys.executable, "-c", PROGRAM, str(cache_home)]
    out = subprocess.run(command, check=True, cwd=ROOT, capture_output=True, text=True).stdout
    assert out.split("\n")[:-1] == ["shirt+clothes"]
