"""The wheel and the source distribution built from this checkout, and the wheel installed with nothing else."""

import os
import subprocess
import sys
import sysconfig
from dataclasses import dataclass
from pathlib import Path

from tests.supply.lock_files import ROOT

SITE = Path(sysconfig.get_path("purelib"))  # where what mocapd runs on is already


def build(source: Path, kind: str, out: Path) -> Path:
    """The built `wheel` or `sdist` of this source tree."""
    command = [
        sys.executable,
        "-m",
        "hatchling",
        "build",
        "--target",
        kind,
        "--directory",
        str(out),
    ]
    subprocess.run(command, cwd=source, check=True, capture_output=True)
    (made,) = out.glob("*.whl" if kind == "wheel" else "*.tar.gz")
    return made


def package_files() -> set[str]:
    """Every file that a wheel must hold of the checkout, as it is named in there."""
    inside = {
        str(path.relative_to(ROOT))
        for path in (ROOT / "mocapd").rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    beside = {
        f"mocapd/{path.relative_to(ROOT)}"
        for folder in ("calib", "systemd")
        for path in (ROOT / folder).rglob("*")
        if path.is_file()
    }
    return inside | beside


@dataclass(frozen=True)
class Installed:
    """An environment with mocapd from a wheel; `command`: its `mocapd`."""

    folder: Path

    @property
    def command(self) -> Path:
        return self.folder / "bin/mocapd"

    def asks(self, env: dict[str, str], code: str) -> str:
        """What its Python prints, run elsewhere than in the checkout."""
        argv = [str(self.folder / "bin/python"), "-c", code]
        done = subprocess.run(
            argv, env=env, cwd=self.folder, capture_output=True, text=True, check=True
        )
        return done.stdout.strip()


def install(wheel: Path, folder: Path) -> Installed:
    """A new environment, with the wheel and a pointer to what is here already: nothing is downloaded."""
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", folder], check=True)
    # a folder named in a .pth is searched, but its own .pth files (our editable install) are not read
    own = next(folder.glob("lib/python3*/site-packages"))
    (own / "dependencies.pth").write_text(f"{SITE}\n")
    into = (sys.executable, "-m", "pip", "--python", str(folder / "bin/python"), "install")
    how = ("--quiet", "--disable-pip-version-check", "--no-deps", "--no-index", "--no-compile")
    # with the checkout in PYTHONPATH pip would find it installed
    subprocess.run([*into, *how, str(wheel)], env=os.environ | {"PYTHONPATH": ""}, check=True)
    return Installed(folder)
