"""The export formats of a recording: one line each in FORMATS."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from mocapd.errors import CannotCreateError
from mocapd.exports.bvh.bvh_writer import bvh_text, frames_in_bvh
from mocapd.exports.c3d.c3d_writer import MOST_FRAMES as MOST_C3D_FRAMES
from mocapd.exports.c3d.c3d_writer import frames_in_c3d, write_c3d
from mocapd.exports.csv_table.csv_writer import csv_text, frames_in_csv
from mocapd.exports.glb.glb_writer import frames_in_glb, glb_bytes, most_glb_frames
from mocapd.exports.sampled_motion import MOST_FRAMES, SampledMotion, too_long
from mocapd.exports.trc.trc_writer import frames_in_trc, trc_text
from mocapd.exports.vrma.vrma_writer import vrma_bytes
from mocapd.output_file import FileKind, OutputFile, kind_by_magic


@dataclass(frozen=True, slots=True)
class ExportFormat:
    """One format. write: takes the motion, the path to write to, and the final file name; frames_in: the number of frames
    in a written file; most_frames: the largest number of frames, by the number of joints; takes_z_up: the format has no
    fixed up axis, or can name it; keeps_all_joints: it needs joints that no camera saw, and leaves them unmoved."""

    write: Callable[[SampledMotion, Path, str], None]
    frames_in: Callable[[Path], int]
    most_frames: Callable[[int], int]
    takes_z_up: bool = True
    keeps_all_joints: bool = False


def _bvh(motion: SampledMotion, path: Path, _name: str) -> None:
    path.write_text(bvh_text(motion), encoding="utf-8")


def _glb(motion: SampledMotion, path: Path, _name: str) -> None:
    path.write_bytes(glb_bytes(motion))


def _vrma(motion: SampledMotion, path: Path, _name: str) -> None:
    path.write_bytes(vrma_bytes(motion))


def _csv(motion: SampledMotion, path: Path, _name: str) -> None:
    path.write_text(csv_text(motion), encoding="utf-8")


def _trc(motion: SampledMotion, path: Path, name: str) -> None:
    path.write_text(trc_text(motion, name), encoding="utf-8")


def _c3d(motion: SampledMotion, path: Path, _name: str) -> None:
    write_c3d(motion, path)


def _unlimited(_joints: int) -> int:
    return MOST_FRAMES


FORMATS: Mapping[str, ExportFormat] = MappingProxyType(
    {
        "bvh": ExportFormat(_bvh, frames_in_bvh, _unlimited),
        "glb": ExportFormat(_glb, frames_in_glb, most_glb_frames, takes_z_up=False),
        "vrma": ExportFormat(
            _vrma, frames_in_glb, most_glb_frames, takes_z_up=False, keeps_all_joints=True
        ),
        "csv": ExportFormat(_csv, frames_in_csv, _unlimited),
        "trc": ExportFormat(_trc, frames_in_trc, _unlimited),
        "c3d": ExportFormat(_c3d, frames_in_c3d, lambda _joints: MOST_C3D_FRAMES),
    }
)

KINDS: Mapping[str, FileKind] = MappingProxyType(
    {
        "bvh": kind_by_magic("a BVH file", b"HIERARCHY"),
        "glb": kind_by_magic("a GLB file", b"glTF"),
        "vrma": kind_by_magic("a VRMA file", b"glTF"),
        "csv": kind_by_magic("a CSV file of mocapd", b"time_s,gap,"),
        "trc": kind_by_magic("a TRC file", b"PathFileType\t"),
        "c3d": kind_by_magic("a C3D file", b"\x02\x50"),
    }
)


def export_file(
    name: str, path: Path, force: bool = False, inputs: Sequence[Path] = ()
) -> OutputFile:
    """The output file of an export in the format of this name. For the rest see OutputFile."""
    return OutputFile(path, KINDS[name], force, inputs)


def write_export(motion: SampledMotion, name: str, out: OutputFile | Path) -> None:
    """Write the format of this name, atomically.

    Raises InputError where the format cannot hold the motion, CannotCreateError where the file cannot be written, or
    holds fewer frames than the motion.
    """
    out = export_file(name, out) if isinstance(out, Path) else out
    export_format, frames = FORMATS[name], len(motion.joints_m)
    most = export_format.most_frames(len(motion.skeleton.names))
    if frames > most:
        raise too_long(frames, most, motion.rate_hz, name.upper(), str(out.path))
    with out.writing() as partial:
        export_format.write(motion, partial, out.path.name)
        written = export_format.frames_in(partial)
        if written != frames:
            raise CannotCreateError(
                f"{written} of {frames} frames are readable in what was written",
                str(out.path),
                "choose another place by --out; if that does not help, another format by --to",
            )
