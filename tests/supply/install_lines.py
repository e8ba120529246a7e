"""The commands that our pages print to install something, and a container in which each runs.

`python -m tests.supply.install_lines` runs every block in a copy of the checkout, with a home, a path and a folder for
temporary files of its own, and prints what each took, in time and on the disk; it asks the package index.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGES = ("README.md", "docs/*.md", "clients/*/README.md")
INSTALLS = re.compile(r"\b(?:pip|pipx|uv pip) (?:install|inject)\b")
# What the index has under this name, and we mean.
FROM_INDEX = {"eclipse-zenoh", "msgspec", "python-osc", "torch", "onnx", "numpy"}
_BLOCK = re.compile(r"```sh\n(.*?)```", re.DOTALL)
_TIMEOUT_S = 900.0
_SYSTEM_PATH = "/usr/local/bin:/usr/bin:/bin"
_OF_INDEX = re.compile(r"PIP_|UV_|SSL_|\w+_proxy$", re.IGNORECASE)  # how the index is reached


@dataclass(frozen=True, slots=True)
class Line:
    """One command, and the page that prints it."""

    page: str
    command: str


def blocks() -> list[tuple[str, str]]:
    """Page and text of each block of commands in which something is installed by pip."""
    pages = [path for pattern in PAGES for path in sorted(ROOT.glob(pattern))]
    return [
        (path.relative_to(ROOT).as_posix(), text)
        for path in pages
        for text in _BLOCK.findall(path.read_text(encoding="utf-8"))
        if INSTALLS.search(text)
    ]


def lines() -> list[Line]:
    """Each installing command, without its comment."""
    return [
        Line(page, command.strip())
        for page, text in blocks()
        for whole in text.splitlines()
        for command in whole.partition("  #")[0].split("&&")
        if INSTALLS.search(command)
    ]


def installing(text: str) -> str:
    """The lines of a block that install, and make what they install into; nothing that starts a program for ever."""
    wanted = [
        one
        for one in text.splitlines()
        if INSTALLS.search(one) or "-m venv" in one or one.startswith("make dist")
    ]
    return "\n".join(wanted)


@dataclass(frozen=True, slots=True)
class Installed:
    """code: exit code; size_mb: of all that is there afterwards and was not in the checkout; said: the end of it."""

    code: int
    took_s: float
    size_mb: float
    said: str


def run(text: str) -> Installed:
    """Run the installing lines of a block."""
    with tempfile.TemporaryDirectory(prefix="mocapd-install-") as folder:
        home, checkout = Path(folder) / "home", Path(folder) / "checkout"
        tools = Path(folder) / "tools"
        home.mkdir()
        checkout.mkdir()
        archive = subprocess.run(
            ["git", "-C", ROOT, "archive", "HEAD"], capture_output=True, check=True
        )
        subprocess.run(["tar", "-x", "-C", checkout], input=archive.stdout, check=True)
        kept = {name: value for name, value in os.environ.items() if _OF_INDEX.match(name)}
        env = kept | {
            "HOME": str(home),
            "TMPDIR": str(home),
            "PATH": f"{tools}/bin:{_SYSTEM_PATH}",
            "LANG": "C.UTF-8",
        }
        if "pipx" in text and shutil.which("pipx", path=_SYSTEM_PATH) is None:
            _get_pipx(tools)
        checkout_mb = size_mb(Path(folder))
        began_s = time.monotonic()
        done = subprocess.run(
            ["bash", "-eu", "-c", installing(text)], cwd=checkout, env=env, capture_output=True, text=True,
            timeout=_TIMEOUT_S, check=False,
        )  # fmt: skip
        took_s = time.monotonic() - began_s
        said = (done.stdout + done.stderr)[-600:]
        return Installed(done.returncode, took_s, size_mb(Path(folder)) - checkout_mb, said)


def _get_pipx(tools: Path) -> None:
    """The pages expect it on the machine; Debian's package of it needs root."""
    subprocess.run([sys.executable, "-m", "venv", tools], check=True)
    subprocess.run([tools / "bin/pip", "install", "--quiet", "pipx"], check=True)


def size_mb(folder: Path) -> float:
    """Of all files, without what installers keep for another time."""
    files = (path for path in folder.rglob("*") if path.is_file() and not path.is_symlink())
    return sum(path.stat().st_size for path in files if ".cache" not in path.parts) / 1e6


def main(wanted: list[str]) -> int:
    """Run those blocks whose page has one of these words in its name, all without a word."""
    failed = 0
    for page, text in blocks():
        if "sudo" in text or (wanted and not any(word in page for word in wanted)):
            continue
        made = run(text)
        failed += made.code != 0
        print(
            f"{page}: exit code {made.code} after {made.took_s:.0f} s, {made.size_mb:.0f} MB",
            flush=True,
        )
        if made.code:
            print(made.said, flush=True)
    return min(failed, 1)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
