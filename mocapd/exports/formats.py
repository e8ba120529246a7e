"""The formats that a recording can be exported to: one line each in FORMATS."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

from mocapd.exports.bvh.bvh_writer import bvh_text
from mocapd.exports.c3d.c3d_writer import write_c3d
from mocapd.exports.csv_table.csv_writer import csv_text
from mocapd.exports.glb.glb_writer import glb_bytes
from mocapd.exports.sampled_motion import SampledMotion
from mocapd.exports.trc.trc_writer import trc_text
from mocapd.output_file import FileKind, OutputFile, kind_by_magic

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

KINDS: Mapping[str, FileKind] = MappingProxyType(
    {
        "bvh": kind_by_magic("a BVH file", b"HIERARCHY"),
        "glb": kind_by_magic("a GLB file", b"glTF"),
        "csv": kind_by_magic("a CSV file of mocapd", b"time_s,gap,"),
        "trc": kind_by_magic("a TRC file", b"PathFileType\t"),
        "c3d": kind_by_magic("a C3D file", b"\x02\x50"),
    }
)


def export_file(
    name: str, path: Path, force: bool = False, inputs: Sequence[Path] = ()
) -> OutputFile:
    """Where the format of this name is written. For the rest see OutputFile."""
    return OutputFile(path, KINDS[name], force, inputs)


def write_export(motion: SampledMotion, name: str, out: OutputFile | Path) -> None:
    """Write the format of this name, whole or not at all. Raises CannotCreateError."""
    out = export_file(name, out) if isinstance(out, Path) else out
    with out.writing() as partial:
        FORMATS[name](motion, partial, out.path.name)
