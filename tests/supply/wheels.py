"""Whether each locked package has a wheel for every Python and machine that the locks are for: part of `make lock`.

Compares the names of the files that the index lists with the tags that pip accepts there, so no wheel is downloaded
and no machine emulated. A wheel counts only with a hash of the lock.
"""

import sys
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import cache

import httpx
from packaging.tags import Tag, compatible_tags, cpython_tags
from packaging.utils import InvalidWheelFilename, parse_wheel_filename

from tests.supply.lock_files import (
    BUILD,
    CLIENTS,
    DEV,
    MACHINES,
    PYTHONS,
    RUN,
    Pin,
    pins,
)
from tests.supply.make_locks import INDEX

LOCKS = (RUN, BUILD, DEV, CLIENTS)
OLDEST_GLIBC_MINOR = 28  # of 2.x: Debian 10, Ubuntu 20.04 and later have it
_LEGACY = {"x86_64": ((17, "2014"), (12, "2010"), (5, "1")), "aarch64": ((17, "2014"),)}
_FIRST_GLIBC_MINOR = {"x86_64": 5, "aarch64": 17}
_JSON = "application/vnd.pypi.simple.v1+json"
_CONNECTIONS = 8
_TIMEOUT_S = 60.0

# of one package: the names of its files by hash, as `sha256:` and 64 hex digits
FilesByHash = Mapping[str, str]


@cache
def accepted_tags(python: str, machine: str) -> frozenset[Tag]:
    """What CPython `python` ("3.13") accepts on Linux with glibc 2.28, on this machine ("aarch64")."""
    major, minor = (int(part) for part in python.split("."))
    platforms = [
        f"manylinux_2_{glibc}_{machine}"
        for glibc in range(OLDEST_GLIBC_MINOR, _FIRST_GLIBC_MINOR[machine] - 1, -1)
    ]
    platforms += [f"manylinux{name}_{machine}" for _, name in _LEGACY[machine]]
    interpreter = f"cp{major}{minor}"
    own = cpython_tags((major, minor), abis=[interpreter], platforms=platforms)
    return frozenset([*own, *compatible_tags((major, minor), interpreter, platforms)])


def is_accepted(file_name: str, python: str, machine: str) -> bool:
    """Whether it is a wheel that pip installs there."""
    try:
        _, _, _, tags = parse_wheel_filename(file_name)
    except InvalidWheelFilename:  # a source distribution
        return False
    return not tags.isdisjoint(accepted_tags(python, machine))


def missing_wheels(
    pin: Pin, files: FilesByHash, machines: tuple[str, ...] = MACHINES
) -> Iterator[str]:
    """The Pythons and machines ("3.13 aarch64") that install the package and for which no locked file is a wheel."""
    locked = [name for digest, name in files.items() if digest in pin.hashes]
    for python in PYTHONS:
        for machine in machines:
            is_there = any(is_accepted(name, python, machine) for name in locked)
            if pin.holds(python, machine) and not is_there:
                yield f"{python} {machine}"


def listed_files(client: httpx.Client, name: str) -> FilesByHash:
    """What the index has of a package, of any version. Raises httpx.HTTPError."""
    answer = client.get(f"{INDEX}/{name}/", headers={"Accept": _JSON})
    answer.raise_for_status()
    return {
        f"sha256:{file['hashes']['sha256']}": file["filename"]
        for file in answer.json()["files"]
        if "sha256" in file["hashes"]
    }


def main() -> int:
    """The exit code: 1 with a line for each package that cannot be installed from a wheel."""
    wanted = {pin for lock in LOCKS for pin in pins(lock).values()}
    names = sorted({pin.name for pin in wanted})
    try:
        with (
            httpx.Client(timeout=_TIMEOUT_S, follow_redirects=True) as client,
            ThreadPoolExecutor(_CONNECTIONS) as pool,
        ):
            files = dict(
                zip(names, pool.map(lambda name: listed_files(client, name), names), strict=True)
            )
    except httpx.HTTPError as error:
        print(f"wheels: the index does not answer: {error}", file=sys.stderr)
        return 1
    holes = {
        f"{pin.name} {pin.version}: {', '.join(missing)}"
        for pin in wanted
        if (missing := list(missing_wheels(pin, files[pin.name])))
    }
    for hole in sorted(holes):
        print(f"wheels: none of {hole}", file=sys.stderr)
    if not holes:
        print(
            f"wheels: all {len(names)} locked packages have one for Python {', '.join(PYTHONS)} on"
            f" {' and '.join(MACHINES)}"
        )
    return 1 if holes else 0


if __name__ == "__main__":
    sys.exit(main())
