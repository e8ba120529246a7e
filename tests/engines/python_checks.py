"""mocapd installed for another Python or machine from the locks' wheels alone, run there, and compared with here."""

import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tests.engines.chroot import CACHE, Chroot
from tests.engines.results import Result, at_most
from tests.outputs.frames import free_port
from tests.supply.distributions import build
from tests.supply.lock_files import DEV, ROOT, RUN

SAME_MM = 0.01
FRAMES = 100
INSTALL_S, DEMO_S, TRACK_S, TESTS_S = 1200.0, 1800.0, 7200.0, 1800.0
TESTS = (
    *("tests/geometry", "tests/boundary", "tests/exports", "tests/outputs/test_wire.py"),
    *("tests/outputs/test_zenoh_strangers.py", "tests/outputs/test_zenoh_sink.py"),
    *("tests/supply/test_locks.py", "tests/supply/test_wheels.py"),
)
MM = 1000.0
_UV = (sys.executable, "-m", "uv", "--no-config", "pip", "install", "--quiet")


@dataclass(frozen=True)
class Platform:
    """python: "3.14"; machine: "aarch64"; work: a folder inside of the chroot."""

    chroot: Chroot
    python: str
    machine: str
    work: Path
    logs: Path

    @property
    def name(self) -> str:
        return f"{self.python} {self.machine}"

    @property
    def venv(self) -> Path:
        """Its environment, which subprocesses of tests find without PYTHONPATH."""
        return self.work / "venv"

    @property
    def site(self) -> Path:
        return self.venv / f"lib/python{self.python}/site-packages"

    def log(self, what: str) -> Path:
        return self.logs / f"{what}-{self.python}-{self.machine}.log"

    def command(self, *words: str) -> list[str]:
        """Of its environment's Python."""
        return [f"{self.chroot.inside(self.venv)}/bin/python", *words]

    @property
    def env(self) -> dict[str, str]:
        home = self.work / "home"
        home.mkdir(exist_ok=True)
        return {"HOME": self.chroot.inside(home)}


def install(platform: Platform, wheel: Path, *, with_tests: bool) -> Result:
    """By hash and from wheels alone, as uv resolves it for that machine; nothing is run there."""
    make = [f"python{platform.python}", "-m", "venv", "--without-pip"]
    log = platform.log("venv")
    if platform.chroot.run([*make, platform.chroot.inside(platform.venv)], log) != 0:
        return Result(platform.name, "environment", f"none; see {log}", "made", False)
    locks = (DEV,) if with_tests else (RUN,)
    target = ["--python-platform", f"{platform.machine}-manylinux_2_28"]
    target += ["--python-version", platform.python, "--target", str(platform.site)]
    cached = ("--cache-dir", str(CACHE / "uv"))
    by_lock = [word for lock in locks for word in ("--requirement", str(lock))]
    env = {name: value for name, value in os.environ.items() if name[:3] != "UV_"}
    for what in (("--require-hashes", *by_lock), ("--no-deps", str(wheel))):
        command = [*_UV, *cached, *target, "--only-binary", ":all:", *what]
        done = subprocess.run(
            command, env=env, capture_output=True, text=True, timeout=INSTALL_S, check=False
        )
        if done.returncode != 0:
            why = (done.stderr.strip().splitlines() or ["no word"])[0]
            return Result(platform.name, "install", why, "from wheels", False)
    log = platform.log("version")
    code = platform.chroot.run(
        platform.command("-m", "mocapd.cli.main", "version"), log, platform.env
    )
    said = (log.read_text().strip().splitlines() or [f"code {code}"])[0]
    return Result(platform.name, "install", f"from wheels: {said}", "from wheels", code == 0)


def track(platform: Platform, capture: Path, here: Path) -> Result:
    """Lossless pictures, against the same tracked on this machine by this Python."""
    place = platform.work / "capture"
    if not place.is_dir():
        shutil.copytree(capture, place)
    out, log = platform.work / f"track-{platform.python}.npz", platform.log("track")
    words = ("-m", "mocapd.cli.main", "track", platform.chroot.inside(place), "--tracker", "shirt")
    command = platform.command(*words, "--out", platform.chroot.inside(out))
    code = platform.chroot.run(command, log, platform.env, TRACK_S)
    if code != 0:
        return Result(platform.name, "track", f"code {code}; see {log}", "0", False)
    ours, theirs = np.load(here)["joints"], np.load(out)["joints"]
    what = f"joints of {len(theirs)} frames tracked, from {_here()}"
    if ours.shape != theirs.shape:
        return Result(platform.name, what, f"{len(theirs)} frames", f"{len(ours)} frames", False)
    apart_mm = MM * float(np.linalg.norm(ours - theirs, axis=2).max())
    return at_most(platform.name, what, apart_mm, SAME_MM, "mm")


def demo(platform: Platform) -> Result:
    """The demo's frames, as `watch --json` has them."""
    settings = ("--set", f"zenoh.port={free_port(socket.SOCK_STREAM)}")
    mocapd = platform.command("-m", "mocapd.cli.main")
    quiet = (
        "--set",
        "web.enabled=false",
        "--set",
        f"osc.destinations=['127.0.0.1:{free_port(socket.SOCK_DGRAM)}']",
    )
    running = platform.chroot.start(
        [*mocapd, "demo", *settings, *quiet], platform.env, platform.log("demo")
    )
    log, begun_s = platform.log("watch"), time.monotonic()
    try:
        watch = (*mocapd, "watch", "--json", "--count", str(FRAMES), "--timeout", "120", *settings)
        code = platform.chroot.run(watch, log, platform.env, DEMO_S)
    finally:
        running.send_signal(signal.SIGINT)
        try:
            running.wait(30)
        except subprocess.TimeoutExpired:
            running.kill()
            running.wait()
    frames = list(_frames(log))
    live = sum(frame.get("tracking") == "live" for frame in frames)
    told = (
        f"{len(frames)} frames, {live} live, {time.monotonic() - begun_s:.0f} s from a cold start"
    )
    # how many are live depends on how busy the machine is
    good = code == 0 and len(frames) == FRAMES and live > 0
    return Result(platform.name, "demo, watch --json", told, f"{FRAMES} frames", good)


def part_of_the_tests(platform: Platform) -> Result:
    """In a copy of the checkout."""
    checkout = platform.work / "checkout"
    if not checkout.is_dir():
        _copy_checkout(checkout)
    log = platform.log("tests")
    tests = ("-m", "pytest", "-q", *TESTS)
    command = ["sh", "-c", f'cd {platform.chroot.inside(checkout)} && exec "$@"', "sh"]
    code = platform.chroot.run([*command, *platform.command(*tests)], log, platform.env, TESTS_S)
    last = (log.read_text(errors="replace").strip().splitlines() or [f"code {code}"])[-1]
    return Result(platform.name, "part of the tests", last.strip("= "), "0 failed", code == 0)


def wheel_of_this_checkout(folder: Path) -> Path:
    return build(ROOT, "wheel", folder)


def _copy_checkout(folder: Path) -> None:
    """Its tracked files; what is new and not ignored too."""
    listed = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    names = subprocess.run(listed, cwd=ROOT, capture_output=True, check=True).stdout
    for name in filter(None, names.decode().split("\0")):
        source, place = ROOT / name, folder / name
        if source.is_file():
            place.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(source, place)


def _frames(log: Path) -> Iterator[dict[str, object]]:
    for line in log.read_text(errors="replace").splitlines():
        if line.startswith("{"):
            yield json.loads(line)


def _here() -> str:
    return f"Python {sys.version_info.major}.{sys.version_info.minor} here"


def track_here(capture: Path, out: Path) -> None:
    """The same by this Python. Raises CalledProcessError."""
    command = [
        sys.executable,
        "-m",
        "mocapd.cli.main",
        "track",
        str(capture),
        "--tracker",
        "shirt",
    ]
    subprocess.run([*command, "--out", str(out)], cwd=ROOT, capture_output=True, check=True)
