"""Writes the rig's file in the capture format, atomically."""

import json
from pathlib import Path

from mocapd.geometry.rig_file import SCHEMA, camera_to_dict
from mocapd.output_file import FileKind, OutputFile
from mocapd.types import Rig


def _begins_as_rig(head: bytes) -> bool:
    return head.lstrip().startswith(b"{") and (b'"cameras"' in head or SCHEMA.encode() in head)


RIG = FileKind("a rig file", _begins_as_rig)


def write_rig(out: OutputFile | Path, rig: Rig) -> None:
    """Write the file atomically. Raises CannotCreateError."""
    cameras = [camera_to_dict(camera) for camera in rig.cameras]
    text = json.dumps({"schema": SCHEMA, "cameras": cameras}, indent=1)
    out = OutputFile(out, RIG) if isinstance(out, Path) else out
    with out.writing() as partial:
        partial.write_text(text + "\n", encoding="utf-8")
