"""Which modules the small install carries: `mocapd.client`, what our own game stands on, and what these import, found by
reading them. Those for the game import libraries that the game brings."""

import ast
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

PACKAGE = "mocapd"
ENTRIES = (
    "mocapd.client",
    # of clients/goalkeeper: recordings, the demo's person, files
    "mocapd.outputs.mcap.recording_reader",
    "mocapd.sim.world",
    "mocapd.child_process",
    "mocapd.geometry",
    "mocapd.whole_file",
)
ASSETS = ("scenarios/living_room.toml", "body_proportions.json")


class ClientModules(BuildHookInterface):  # type: ignore[type-arg]
    """Puts them into wheel and sdist, under the names that they are imported by."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:  # noqa: ARG002
        """Called by hatchling before it builds."""
        here = Path(self.root)
        unpacked = (here / PACKAGE).is_dir()  # an sdist, which carries them beside this file
        top = here if unpacked else here.parents[1]
        for path in modules_of(ENTRIES, top):
            build_data["force_include"][str(path)] = path.relative_to(top).as_posix()
        calib = here / PACKAGE / "calib" if unpacked else top / "calib"
        for name in ASSETS:
            build_data["force_include"][str(calib / name)] = f"{PACKAGE}/calib/{name}"


def modules_of(entries: Iterable[str], top: Path) -> list[Path]:
    """The files below `top` that importing these may load, with the packages they are in."""
    found: dict[str, Path] = {}
    waiting = list(entries)
    while waiting:
        name = waiting.pop()
        path = _file_of(name, top)
        if path is None or name in found:
            continue
        found[name] = path
        waiting += [name.rpartition(".")[0], *_imported(path)]
    return sorted(found.values())


def _file_of(name: str, top: Path) -> Path | None:
    """None for what is no module of ours, but a name in one or another's package."""
    base = top.joinpath(*name.split("."))
    places = (base.with_suffix(".py"), base / "__init__.py")
    ours = name.partition(".")[0] == PACKAGE
    return next((path for path in places if ours and path.is_file()), None)


def _imported(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
