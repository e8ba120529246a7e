"""What a machine does to a daemon: its clock is set, its disk is full, its memory is short."""

import json
import resource
import shutil
import struct
import subprocess
import sys
import time
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from pathlib import Path

import pytest

from tests.conftest import ROOT
from tests.faults.faulty_daemon import FaultyDaemon, faulty_daemon

pytestmark = pytest.mark.kernels

HOUR_NS = 3600 * 10**9
COASTS_AFTER_NS = 10**8
SHIFTED_CLOCK = ROOT / "tests" / "faults" / "shifted_clock.c"


@pytest.fixture
def home(tmp_path: Path, clean_env: dict[str, str], monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder for a daemon; what is made once and kept is that of all tests."""
    monkeypatch.setenv("XDG_CACHE_HOME", clean_env["XDG_CACHE_HOME"])
    folder = tmp_path / "daemon"
    folder.mkdir()
    return folder


def more_bodies(daemon: FaultyDaemon, count: int) -> None:
    wanted = len(daemon.bodies) + count
    daemon.until(lambda: len(daemon.bodies) >= wanted, f"{count} bodies", 60.0)


@dataclass(frozen=True)
class Clocks:
    """Of a daemon: its wall clock is set and its machine sleeps by a file."""

    library: Path
    file: Path

    @property
    def env(self) -> dict[str, str]:
        return {"LD_PRELOAD": str(self.library), "CLOCK_SHIFT_FILE": str(self.file)}

    def shift(self, wall_ns: int = 0, slept_ns: int = 0) -> None:
        with self.file.open("r+b") as file:
            file.write(struct.pack("qq", wall_ns, slept_ns))


@pytest.fixture
def clocks(tmp_path: Path) -> Clocks:
    if shutil.which("cc") is None:
        pytest.skip("no C compiler to make a clock with")
    clocks = Clocks(tmp_path / "clock.so", tmp_path / "shift")
    words = ["cc", "-shared", "-fPIC", "-o", str(clocks.library), str(SHIFTED_CLOCK), "-ldl"]
    subprocess.run(words, check=True)
    clocks.file.write_bytes(bytes(16))
    return clocks


def reopened(daemon: FaultyDaemon, times: int) -> bool:
    return [status.reopened for status in daemon.told.values()] == [times] * 2


def test_a_wall_clock_that_is_set_changes_nothing_else_and_after_a_sleep_cameras_are_opened_again(
    home: Path, simulated: str, clocks: Clocks
) -> None:
    words = ("--capture", simulated, "--tracker", "canned")
    with faulty_daemon(home, *words, env=clocks.env) as daemon:
        more_bodies(daemon, 20)
        for ns in (HOUR_NS, -24 * HOUR_NS, 0):
            clocks.shift(wall_ns=ns)
            more_bodies(daemon, 40)
            said_ns = daemon.bodies[-1].unix_ns
            assert abs(said_ns - time.time_ns() - ns) < 5 * 10**9
        assert all(status.reopened == 0 for status in daemon.told.values())
        bodies = daemon.bodies[:]
        assert {b.seq - a.seq for a, b in pairwise(bodies)} == {1}
        assert all(b.t_ns > a.t_ns for a, b in pairwise(bodies))
        # coasting only where this machine gave the daemon no processor for so long
        assert all(
            b.tracking == "live" or (b.tracking == "coasting" and b.t_ns - a.t_ns > COASTS_AFTER_NS)
            for a, b in pairwise(bodies)
        )
        for times in (1, 2):
            clocks.shift(slept_ns=times * HOUR_NS)
            daemon.until(partial(reopened, daemon, times), "cameras opened again", 30.0)
        more_bodies(daemon, 20)
        assert daemon.log.count("the machine has slept for 3600 s") >= 2
        assert daemon.end() == 0


def own_disk() -> bool:
    """Whether a process may have a disk of its own: namespaces are not allowed everywhere."""
    if shutil.which("unshare") is None:
        return False
    words = ["unshare", "--map-root-user", "--mount", "true"]
    return subprocess.run(words, check=False, capture_output=True).returncode == 0


@pytest.mark.skipif(not own_disk(), reason="no mount namespace is to be had")
def test_a_full_disk_is_named_and_nothing_that_was_saved_is_lost(
    tmp_path: Path, clean_env: dict[str, str]
) -> None:
    words = ["unshare", "--map-root-user", "--mount", sys.executable]
    ran = subprocess.run(
        [*words, "-m", "tests.faults.on_a_full_disk", str(tmp_path)],
        cwd=ROOT,
        env=clean_env | {"PATH": "/usr/sbin:/usr/bin:/sbin:/bin"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr
    found = json.loads(ran.stdout)
    for kind, place in (("calibration", "calibration.toml"), ("cache", "numbers")):
        assert "No space left on device" in found[kind]["said"]
        assert place in found[kind]["said"]
        assert (found[kind]["kept"], found[kind]["left"], found[kind]["then"]) == (7, [], 9)
    recording = found["recording"]
    assert "a.mcap: cannot be written any further (No space left on device)" in recording["said"]
    assert recording["handed_over"] - recording["read"] < 60  # a second


def test_a_daemon_that_gets_no_more_memory_goes_on_with_what_it_has(
    home: Path, simulated: str
) -> None:
    """Once it runs it needs none; where some is needed and refused, a thread dies, and that ends with 70."""
    with faulty_daemon(home, "--capture", simulated, "--tracker", "canned") as daemon:
        more_bodies(daemon, 60)
        mapped = int(Path(f"/proc/{daemon.process.pid}/statm").read_text().split()[0])
        limit = mapped * resource.getpagesize()
        resource.prlimit(daemon.process.pid, resource.RLIMIT_AS, (limit, limit))
        more_bodies(daemon, 120)
        # nothing pauses; single frame sets may be dropped, as the machine is busy with other tests
        assert max(b.seq - a.seq for a, b in pairwise(daemon.bodies)) < 10
        assert daemon.end() == 0
