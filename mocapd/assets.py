"""Where the files of `calib/` are: beside the package in a checkout, inside it when installed."""

from pathlib import Path

from mocapd.errors import InputError


def asset_path(name: str) -> Path:
    """The path of an asset such as `shirt_standard_v1.json`. Raises InputError when it is not installed."""
    package = Path(__file__).resolve().parent
    for folder in (package / "calib", package.parent / "calib"):
        if (folder / name).exists():
            return folder / name
    raise InputError(f"the asset {name!r} is not installed", str(package), "install mocapd again")
