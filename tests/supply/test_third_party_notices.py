"""The notices name what the runtime locks install, in its versions, and what its wheels carry."""

import re
from importlib import metadata

from tests.supply.bundled_libraries import CARRIED, WORKS, carried_by_installed
from tests.supply.lock_files import Pin, runtime_pins
from tests.supply.third_party_notices import PAGE, row

MAKE_ANEW = "run in an environment made by `make dev`: python -m tests.supply.third_party_notices"


def installed_pins() -> list[Pin]:
    """All, but where the extra has no wheel."""
    return [pin for pin in runtime_pins() if is_installed(pin.name)]


def is_installed(name: str) -> bool:
    return next(iter(metadata.Distribution.discover(name=name)), None) is not None


def test_names_and_versions_are_those_of_the_runtime_locks() -> None:
    packages = PAGE.read_text().split("|---|---|---|\n")[1].split("\n\n")[0]
    named = re.findall(r"^\| (\S+) \| (\S+) \| [^|]+ \|$", packages, re.MULTILINE)
    assert named == [(pin.name, pin.version) for pin in runtime_pins()], MAKE_ANEW


def test_licences_are_those_that_installed_packages_tell() -> None:
    lines = PAGE.read_text().splitlines()
    for pin in installed_pins():
        if metadata.version(pin.name) == pin.version:  # without a lock pip may have chosen another
            assert row(pin) in lines, MAKE_ANEW


def test_every_library_that_an_installed_wheel_carries_is_named() -> None:
    lines = PAGE.read_text().splitlines()
    for pin in installed_pins():
        unnamed = carried_by_installed(pin.name) - set(CARRIED.get(pin.name, ()))
        assert not unnamed, f"{pin.name} carries more: bundled_libraries.py, then {MAKE_ANEW}"
    for wheel, stems in CARRIED.items():
        assert wheel in {pin.name for pin in runtime_pins()}
        told = [line for line in lines if line.startswith(f"| {wheel} | ")]
        for name in stems:
            assert any(name in line and WORKS[name][1] in line for line in told), MAKE_ANEW
