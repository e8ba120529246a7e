"""`mocapd-client` built, installed into an empty folder, and a game that has nothing else but its two libraries."""

import ast
import json
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import msgspec
import pytest
import zenoh
from hatchling.builders.sdist import SdistBuilder
from hatchling.builders.wheel import WheelBuilder

from mocapd import __version__
from mocapd.outputs.zenoh.zenoh_config import Params
from mocapd.outputs.zenoh.zenoh_sink import ZenohSink
from tests.clients.canned_daemon import INSTANCE, canned_daemon
from tests.outputs.frames import free_port

ROOT = Path(__file__).resolve().parents[2]
SOURCES = ROOT / "clients" / "python"
HEAVY = ("numpy", "cv2", "numba", "scipy", "pip")
GAME = f"""
import importlib.util, json, sys
sys.path[:0] = sys.argv[2:]
there = [name for name in {HEAVY} if importlib.util.find_spec(name)]
import mocapd.client
with mocapd.client.Client(mocapd.client.Link(sys.argv[1])) as client:
    bodies = [client.wait(30.0) for _ in range(3)]
    rest = client.rest(30.0)
body = bodies[-1]
told = [there, mocapd.client.__file__, body["leftHand"].position_m, rest.stature_m, body.frame.instance]
print(json.dumps(told))
"""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    (path,) = WheelBuilder(str(SOURCES)).build(directory=str(folder), versions=["standard"])
    return Path(path)


def test_a_game_runs_on_it_with_zenoh_and_msgspec_alone(wheel: Path, tmp_path: Path) -> None:
    target, libraries = tmp_path / "installed", tmp_path / "libraries"
    install = ["install", "--quiet", "--no-index", "--no-deps", "--target", str(target), str(wheel)]
    subprocess.run([sys.executable, "-m", "pip", *install], check=True)
    libraries.mkdir()
    for library in (zenoh, msgspec):
        (libraries / library.__name__).symlink_to(Path(str(library.__file__)).parent)
    port = free_port()
    with canned_daemon(ZenohSink(Params(port=port), INSTANCE)):
        # -I and -S: neither this environment's packages nor its variables
        game = subprocess.run(
            [sys.executable, "-I", "-S", "-c", GAME, f"tcp/127.0.0.1:{port}", target, libraries],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
    assert game.returncode == 0, game.stderr
    there, file, hand_m, stature_m, instance = json.loads(game.stdout)
    assert there == []
    assert Path(file) == target / "mocapd" / "client.py"
    assert hand_m[1] > 1.0, "the canned person waves"
    assert stature_m == pytest.approx(1.75)
    assert instance == INSTANCE


def test_the_goalkeeper_finds_in_it_all_that_it_imports(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as opened:
        there = {name.removesuffix(".py").replace("/", ".") for name in opened.namelist()}
    sources = sorted((ROOT / "clients" / "goalkeeper" / "goalkeeper").rglob("*.py"))
    asked = {
        node.module
        for source in sources
        for node in ast.walk(ast.parse(source.read_text()))
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("mocapd.")
    }
    assert {"mocapd.client", "mocapd.child_process"} <= asked
    assert {one for one in asked if not {one, f"{one}.__init__"} & there} == set()


def test_it_carries_the_clients_modules_and_nothing_of_the_tracker(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as opened:
        modules = {name for name in opened.namelist() if name.endswith(".py")}
        information = next(name for name in opened.namelist() if name.endswith("METADATA"))
        metadata = opened.read(information).decode()
    assert {"mocapd/client.py", "mocapd/outputs/wire.py", "mocapd/__init__.py"} <= modules
    assert not [one for one in modules if one.startswith(("mocapd/trackers/", "mocapd/cli/"))]
    assert f"\nVersion: {__version__}\n" in metadata


def test_a_wheel_made_of_its_sdist_is_the_same(wheel: Path, tmp_path: Path) -> None:
    (archive,) = SdistBuilder(str(SOURCES)).build(directory=str(tmp_path), versions=["standard"])
    # Debian 12's own Python has no safe way of its own to unpack
    subprocess.run(["tar", "-xzf", archive, "-C", tmp_path], check=True)
    unpacked = tmp_path / Path(archive).name.removesuffix(".tar.gz")
    (path,) = WheelBuilder(str(unpacked)).build(directory=str(tmp_path), versions=["standard"])
    with zipfile.ZipFile(path) as one, zipfile.ZipFile(wheel) as other:
        assert {name: one.read(name) for name in one.namelist()} == {
            name: other.read(name) for name in other.namelist()
        }


def test_it_asks_for_the_bounds_and_the_licence_of_mocapd() -> None:
    client = tomllib.loads((SOURCES / "pyproject.toml").read_text())["project"]
    mocapd = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert set(client["dependencies"]) <= set(mocapd["dependencies"])
    assert client["requires-python"] == mocapd["requires-python"]
    assert (SOURCES / "LICENSE").read_bytes() == (ROOT / "LICENSE").read_bytes()
