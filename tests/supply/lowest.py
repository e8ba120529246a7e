"""`make test-lowest`: some tests of each library with the oldest versions that pyproject.toml allows.

The environment is made for this and thrown away. The tools of the tests are as locked; what the libraries themselves
ask for is the newest, as a bound of theirs is theirs to test.
"""

import os
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from tests.supply.lock_files import DEV, PROJECT, PYTHONS, ROOT, pins

UV = (sys.executable, "-m", "uv", "--no-config")
TOOLS = (
    "bvhio",
    "httpx",
    "hypothesis",
    "packaging",
    "pygltflib",
    "pypdfium2",
    "pytest",
)
# Each library is used by one of them; none that compiles much: a few minutes in all.
TESTS = (
    *("boundary", "config", "control", "doctor", "exports", "geometry", "printing", "body"),
    *(f"outputs/test_{name}.py" for name in ("client", "foxglove", "osc", "recording", "wire")),
    *(f"outputs/test_zenoh_{name}.py" for name in ("network", "sink", "strangers")),
    *(f"web/test_{name}.py" for name in ("access", "connections", "frames_access", "malformed")),
    *(f"web/test_{name}.py" for name in ("metrics", "pictures", "server")),
    *(f"capture/test_{name}.py" for name in ("file", "identity", "plug_events", "webcams")),
    *("calibrate/test_board.py", "cli/test_commands.py", "cli/test_man_and_completion.py"),
    "fit/test_step.py",
)


def versions(text: str) -> dict[str, str]:
    """By name, of what uv has resolved."""
    lines = (line.partition("==") for line in text.splitlines() if "==" in line)
    return {canonicalize_name(name): version.split()[0] for name, _, version in lines}


def main() -> int:
    """The exit code of the tests."""
    with tempfile.TemporaryDirectory(prefix="mocapd-lowest-") as folder:
        place = Path(folder)
        lowest, python = place / "lowest.txt", str(place / "venv" / "bin" / "python")
        _uv(
            *("pip", "compile", "--quiet", "--resolution", "lowest-direct", "--no-header"),
            *("--python-version", PYTHONS[0], "--only-binary", ":all:", "--no-annotate"),
            *(str(PROJECT), "--extra", "all", "--output-file", str(lowest)),
        )
        _tell(versions(lowest.read_text()))
        tools = place / "tools.txt"
        locked = pins(DEV)
        tools.write_text("".join(f"{name}=={locked[name].version}\n" for name in TOOLS))
        _uv("venv", "--quiet", "--python", sys.executable, str(place / "venv"))
        install = ("pip", "install", "--quiet", "--only-binary", ":all:", "--python", python)
        _uv(*install, "--requirement", str(lowest), "--requirement", str(tools))
        environment = os.environ | {
            "PYTHONPATH": str(ROOT),
            "NUMBA_CACHE_DIR": str(place / "numba"),
            "PYTHONDONTWRITEBYTECODE": "1",
        }
        tests = [str(ROOT / "tests" / name) for name in TESTS]
        command = [python, "-m", "pytest", "-q", "-o", f"cache_dir={place / 'cache'}", *tests]
        return subprocess.run(command, cwd=ROOT, env=environment, check=False).returncode


def _tell(resolved: dict[str, str]) -> None:
    """Which versions are tried."""
    project = tomllib.loads(PROJECT.read_text())["project"]
    extras = project["optional-dependencies"]
    for text in (*project["dependencies"], *extras["print"], *extras["plots"], *extras["vrchat"]):
        version = resolved.get(canonicalize_name(Requirement(text).name), "not on this machine")
        print(f"{text:36}{version}", flush=True)


def _uv(*arguments: str) -> None:
    environment = {name: value for name, value in os.environ.items() if name[:3] != "UV_"}
    subprocess.run([*UV, *arguments], cwd=ROOT, env=environment, check=True)


if __name__ == "__main__":
    sys.exit(main())
