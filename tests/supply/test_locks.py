"""The locks pin everything the project needs, by hash, and say nothing of the machine they were made on."""

import ast
import re
import sys
import tomllib
from importlib import metadata
from pathlib import Path
from typing import Any

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from mocapd.extras import EXTRAS
from tests.supply.lock_files import (
    BUILD,
    CLIENTS,
    DEV,
    MACHINES,
    PROJECT,
    PYTHONS,
    ROOT,
    RUN,
    Pin,
    pins,
    statements,
)

LOCKS = (RUN, BUILD, DEV, CLIENTS)
each_lock = pytest.mark.parametrize("lock", LOCKS, ids=lambda path: path.stem)


def _project() -> dict[str, Any]:
    return tomllib.loads(PROJECT.read_text())


def _asked(lock: Path) -> list[Requirement]:
    """What pyproject.toml asks for that this lock must answer."""
    project = _project()
    extras = project["project"]["optional-dependencies"]
    run = [*project["project"]["dependencies"], *extras["print"]]
    build = project["build-system"]["requires"]
    dev = [*run, *build, *extras["dev"], *extras["plots"], *extras["vrchat"]]
    clients = [*dev, *extras["clients"]]
    asked = {RUN: run, BUILD: build, DEV: dev, CLIENTS: clients}[lock]
    return [Requirement(text) for text in asked]


def _extras() -> list[Requirement]:
    """What a user may have installed besides; who imports it says by name when it is not there."""
    extras = _project()["project"]["optional-dependencies"]
    return [Requirement(text) for name in EXTRAS for text in extras[name]]


def test_the_errors_name_the_extras_and_their_libraries_as_pyproject_has_them() -> None:
    extras = _project()["project"]["optional-dependencies"]
    assert {*EXTRAS, "all", "clients", "dev"} == {*extras}
    (everything,) = map(Requirement, extras["all"])
    assert everything.extras == {*EXTRAS}
    for extra, library in EXTRAS.items():
        assert [Requirement(text).name for text in extras[extra]] == [library]


@each_lock
def test_every_entry_is_one_version_with_hashes(lock: Path) -> None:
    entries = pins(lock)
    assert entries
    for pin in entries.values():
        assert pin.hashes, pin.name
        for digest in pin.hashes:
            assert re.fullmatch(r"sha256:[0-9a-f]{64}", digest), pin.name


@each_lock
def test_no_index_host_or_file_is_named(lock: Path) -> None:
    text = lock.read_text()
    assert "://" not in text
    assert " @ " not in text
    assert "file:" not in text
    # options such as --index-url, --find-links, --trusted-host; in comments too, but for uv's own
    assert set(re.findall(r"(?<!\S)--[a-z-]+", text)) == {"--hash"}
    # the only files named are where a requirement comes from
    paths = {word for word in re.split(r"[\s()]+", text) if "/" in word or "\\" in word[:-1]}
    assert paths <= {f"locks/{DEV.name}"}
    for line in statements(lock):
        assert re.match(r"[a-z0-9-]+==", line), line


@each_lock
def test_what_pyproject_asks_for_is_there_within_its_bounds(lock: Path) -> None:
    entries = pins(lock)
    for asked in _asked(lock):
        pin = entries[canonicalize_name(asked.name)]
        assert asked.specifier.contains(pin.version), f"{asked} and {pin.version}: run make lock"
        wanted = Pin(asked.name, "", asked.marker, frozenset())
        for python in PYTHONS:
            for machine in MACHINES:
                assert pin.holds(python, machine) or not wanted.holds(python, machine), pin.name


@pytest.mark.parametrize("part", [RUN, BUILD], ids=lambda path: path.stem)
def test_the_developers_set_holds_the_others_as_they_are(part: Path) -> None:
    everything = pins(DEV)
    for name, pin in pins(part).items():
        assert everything[name] == pin


def test_the_runtime_holds_no_tool_of_the_developers() -> None:
    tools = {canonicalize_name(asked.name) for asked in _asked(DEV)}
    wanted = {canonicalize_name(asked.name) for asked in _asked(RUN)}
    # packaging is matplotlib's too
    assert not (tools - wanted - {"packaging"}) & set(pins(RUN))


def test_the_debian_package_holds_nothing_that_only_evaluation_needs() -> None:
    script = (ROOT / "deb" / "build.sh").read_text()
    assert set(re.findall(r"locks/[\w.]+", script)) == {"locks/run.txt"}
    assert not {"matplotlib", "ezc3d", "contourpy"} & set(pins(RUN))


def test_apis_that_a_major_may_break_have_a_bound_above() -> None:
    bounded = {
        asked.name for asked in _asked(RUN) if any(part.operator == "<" for part in asked.specifier)
    }
    assert bounded >= {
        *("eclipse-zenoh", "msgspec", "numba", "numpy", "opencv-python-headless"),
        *("starlette", "typer", "uvicorn", "websockets"),
    }


def test_what_the_product_imports_is_asked_for() -> None:
    """So every command works in the environment of `make env`, without the developers' tools."""
    imported: dict[str, Path] = {}
    for path in (ROOT / "mocapd").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                imported |= {alias.name.split(".")[0]: path for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module:
                imported[node.module.split(".")[0]] = path
    packages = metadata.packages_distributions()
    asked = {canonicalize_name(requirement.name) for requirement in (*_asked(RUN), *_extras())}
    for module, path in imported.items():
        if module not in sys.stdlib_module_names and module != "mocapd":
            givers = {canonicalize_name(name) for name in packages.get(module, [module])}
            assert givers & asked, f"{path.name} imports {module}"
