"""The check of wheels finds what cannot be installed without compiling, by file names that are made up."""

import re

import pytest
from packaging.markers import Marker

from tests.supply.lock_files import MACHINES, PYTHONS, ROOT, Pin
from tests.supply.wheels import LOCKS, is_accepted, missing_wheels

X86 = "manylinux_2_17_x86_64.manylinux2014_x86_64"
ARM = "manylinux_2_17_aarch64.manylinux2014_aarch64"
EVERYWHERE = {f"{python} {machine}" for python in ("3.11", "3.14") for machine in MACHINES}


def pin(*file_names: str, marker: str | None = None) -> Pin:
    """An entry whose lock has the hashes of these files."""
    hashes = frozenset(f"sha256:{name}" for name in file_names)
    return Pin("made-up", "1.0", None if marker is None else Marker(marker), hashes)


def missing(locked: Pin, *file_names: str, machines: tuple[str, ...] = MACHINES) -> list[str]:
    return list(missing_wheels(locked, {f"sha256:{name}": name for name in file_names}, machines))


@pytest.mark.parametrize(
    ("file_name", "where"),
    [
        ("made_up-1.0-py3-none-any.whl", EVERYWHERE),
        (f"made_up-1.0-cp311-cp311-{X86}.whl", {"3.11 x86_64"}),
        (f"made_up-1.0-cp314-cp314-{ARM}.whl", {"3.14 aarch64"}),
        (f"made_up-1.0-cp314-cp314t-{ARM}.whl", set()),
        (f"made_up-1.0-cp39-abi3-{ARM}.whl", {"3.11 aarch64", "3.14 aarch64"}),
        ("made_up-1.0-py3-none-manylinux1_x86_64.whl", {"3.11 x86_64", "3.14 x86_64"}),
        ("made_up-1.0-cp311-cp311-manylinux_2_34_x86_64.whl", set()),
        ("made_up-1.0-cp311-cp311-musllinux_1_2_x86_64.whl", set()),
        ("made_up-1.0-cp311-cp311-macosx_11_0_arm64.whl", set()),
        ("made_up-1.0.tar.gz", set()),
    ],
)
def test_a_wheel_is_for_the_pythons_and_machines_of_its_tags(
    file_name: str, where: set[str]
) -> None:
    accepted = {place for place in EVERYWHERE if is_accepted(file_name, *place.split())}
    assert accepted == where


def test_a_package_without_a_wheel_for_one_machine_is_named_for_each_python() -> None:
    """As ezc3d was."""
    files = [f"made_up-1.0-cp3{minor}-cp3{minor}-{X86}.whl" for minor in (11, 12, 13, 14)]
    files.append("made_up-1.0.tar.gz")
    assert missing(pin(*files), *files) == [f"{python} aarch64" for python in PYTHONS]
    assert missing(pin(*files), *files, machines=("x86_64",)) == []
    assert missing(pin(*files, marker="platform_machine == 'x86_64'"), *files) == []


def test_a_wheel_that_the_lock_has_no_hash_of_does_not_count() -> None:
    wheel = "made_up-1.0-py3-none-any.whl"
    assert missing(pin(wheel), wheel) == []
    assert len(missing(pin("made_up-1.0.tar.gz"), wheel)) == len(PYTHONS) * len(MACHINES)


def test_make_lock_ends_with_it_for_every_lock() -> None:
    locks = {path for path in (ROOT / "locks").iterdir() if path.suffix == ".txt"}
    assert set(LOCKS) == locks
    rule = re.search(r"^lock:.*\n((?:\t.*\n)+)", (ROOT / "Makefile").read_text(), re.MULTILINE)
    assert rule is not None
    assert "\t$(BIN)/python -m tests.supply.wheels\n" in rule[1]
