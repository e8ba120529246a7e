"""The lock files as data: what they pin, for which platform, and the hashes they accept."""

import re
from dataclasses import dataclass
from pathlib import Path

from packaging.markers import Marker
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).resolve().parents[2]
PROJECT = ROOT / "pyproject.toml"
RUN, BUILD, DEV, CLIENTS = (
    ROOT / "locks" / f"{name}.txt" for name in ("run", "build", "dev", "clients")
)

# what the lock is for; Makefile asks the same of the environment's Python
PYTHONS = ("3.11", "3.12", "3.13", "3.14")
MACHINES = ("x86_64", "aarch64")


def applies(marker: Marker | None, python: str, machine: str) -> bool:
    """Whether a requirement with this marker is one on a Linux machine with this Python."""
    return marker is None or marker.evaluate(
        {
            "implementation_name": "cpython",
            "platform_python_implementation": "CPython",
            "os_name": "posix",
            "sys_platform": "linux",
            "platform_system": "Linux",
            "platform_machine": machine,
            "python_version": python,
            "python_full_version": f"{python}.0",
        }
    )


@dataclass(frozen=True)
class Pin:
    """One entry of a lock."""

    name: str  # canonical, as in `eclipse-zenoh`
    version: str
    marker: Marker | None
    hashes: frozenset[str]  # as written: `sha256:` and 64 hex digits

    def holds(self, python: str, machine: str) -> bool:
        """Whether a Linux machine with this Python installs it."""
        return applies(self.marker, python, machine)

    @property
    def on_linux(self) -> bool:
        """Whether any platform that the lock is for installs it."""
        return any(self.holds(python, machine) for python in PYTHONS for machine in MACHINES)


def statements(lock: Path) -> list[str]:
    """The lines of a lock without comments, those that go on (`\\`) joined."""
    joined = lock.read_text().replace("\\\n", " ")
    return [line.strip() for line in joined.splitlines() if line.strip() and line.strip()[0] != "#"]


def pins(lock: Path) -> dict[str, Pin]:
    """The entries by name. Raises ValueError for a line that is no `name==version` or is there twice."""
    found: dict[str, Pin] = {}
    for line in statements(lock):
        requirement = Requirement(re.sub(r"--hash=\S+", "", line).strip())
        name = canonicalize_name(requirement.name)
        exact = re.fullmatch(r"==([^=*,]+)", str(requirement.specifier))
        if requirement.url or requirement.extras or exact is None or name in found:
            raise ValueError(
                f"{lock.name}: not one exact version, once: {line.split(' --hash')[0]}"
            )
        hashes = frozenset(re.findall(r"--hash=(\S+)", line))
        found[name] = Pin(name, exact[1], requirement.marker, hashes)
    return found


def runtime_pins() -> list[Pin]:
    """What Linux installs for a user, by name."""
    installed = {name: pin for name, pin in pins(RUN).items() if pin.on_linux}
    return [installed[name] for name in sorted(installed)]
