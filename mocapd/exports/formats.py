"""The formats that a recording can be exported to: one line each in FORMATS."""

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType

from mocapd.errors import CannotCreateError
from mocapd.exports.bvh.bvh_writer import bvh_text
from mocapd.exports.c3d.c3d_library import c3d_library
from mocapd.exports.c3d.c3d_writer import write_c3d
from mocapd.exports.csv_table.csv_writer import csv_text
from mocapd.exports.glb.glb_writer import glb_bytes
from mocapd.exports.sampled_motion import SampledMotion
from mocapd.exports.trc.trc_writer import trc_text
from mocapd.whole_file import whole_file

Write = Callable[
    [SampledMotion, Path, str], None
]  # the motion, where to, the name that the file will have


def _bvh(motion: SampledMotion, path: Path, _name: str) -> None:
    path.write_text(bvh_text(motion), encoding="utf-8")


def _glb(motion: SampledMotion, path: Path, _name: str) -> None:
    path.write_bytes(glb_bytes(motion))


def _csv(motion: SampledMotion, path: Path, _name: str) -> None:
    path.write_text(csv_text(motion), encoding="utf-8")


def _trc(motion: SampledMotion, path: Path, name: str) -> None:
    path.write_text(trc_text(motion, name), encoding="utf-8")


def _c3d(motion: SampledMotion, path: Path, _name: str) -> None:
    write_c3d(motion, path)


FORMATS: Mapping[str, Write] = MappingProxyType(
    {"bvh": _bvh, "glb": _glb, "csv": _csv, "trc": _trc, "c3d": _c3d}
)


def check_library(name: str) -> None:
    """Raise UnavailableError where the format of this name needs a library that is not installed."""
    if name == "c3d":
        c3d_library()


def write_export(motion: SampledMotion, name: str, path: Path) -> None:
    """Write the format of this name, whole or not at all. Raises CannotCreateError."""
    try:
        with whole_file(path) as partial:
            FORMATS[name](motion, partial, path.name)
    except OSError as error:
        raise CannotCreateError(
            f"cannot be written ({error.strerror})", str(path), "choose another place by --out"
        ) from None
