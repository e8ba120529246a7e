"""The commands that our pages print to install something, and a container in which each runs.

`python -m tests.supply.install_lines` runs every block in a copy of the checkout, with a home, a path and a folder for
temporary files of its own, and prints what each took; it asks the package index.
"""

import os
import re
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


def run(page: str, text: str) -> tuple[int, float, str]:
    """Exit code, seconds and the end of what it said."""
    with tempfile.TemporaryDirectory(prefix="mocapd-install-") as folder:
        home, checkout = Path(folder) / "home", Path(folder) / "checkout"
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
            "PATH": "/usr/local/bin:/usr/bin:/bin",
            "LANG": "C.UTF-8",
        }
        began_s = time.monotonic()
        done = subprocess.run(
            ["bash", "-eu", "-c", installing(text)], cwd=checkout, env=env, capture_output=True, text=True,
            timeout=_TIMEOUT_S, check=False,
        )  # fmt: skip
        return done.returncode, time.monotonic() - began_s, (done.stdout + done.stderr)[-600:]


def main(wanted: list[str]) -> int:
    """Run those blocks whose page has one of these words in its name, all without a word."""
    failed = 0
    for page, text in blocks():
        if "sudo" in text or (wanted and not any(word in page for word in wanted)):
            continue
        code, took_s, said = run(page, text)
        failed += code != 0
        print(f"{page}: exit code {code} after {took_s:.0f} s", flush=True)
        if code:
            print(said, flush=True)
    return min(failed, 1)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
