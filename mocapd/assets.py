"""Paths of the files in `calib/` and `systemd/`: next to the package in a checkout, inside it when installed."""

from pathlib import Path

from mocapd.errors import InputError


def asset_path(name: str) -> Path:
    """The path of an asset such as `shirt_standard_v1.json`. Raises InputError when it is not installed."""
    return _find("calib", name)


def systemd_path(name: str) -> Path:
    """The path of a unit or another file for systemd. Raises InputError when it is not installed."""
    return _find("systemd", name)


def _find(folder: str, name: str) -> Path:
    package = Path(__file__).resolve().parent
    for place in (package / folder, package.parent / folder):
        if (place / name).exists():
            return place / name
    raise InputError(f"the asset {name!r} is not installed", str(package), "install mocapd again")
