"""The rig's file in the capture format, written whole or not at all."""

import json
from pathlib import Path

from mocapd.errors import CannotCreateError
from mocapd.geometry.rig_file import SCHEMA, camera_to_dict
from mocapd.types import Rig
from mocapd.whole_file import whole_file


def write_rig(path: Path, rig: Rig) -> None:
    """Write the file whole or not at all. Raises CannotCreateError."""
    cameras = [camera_to_dict(camera) for camera in rig.cameras]
    text = json.dumps({"schema": SCHEMA, "cameras": cameras}, indent=1)
    try:
        with whole_file(path) as partial:
            partial.write_text(text + "\n", encoding="utf-8")
    except OSError as error:
        raise CannotCreateError(
            f"cannot be written ({error.strerror})", str(path), "make room or choose another place"
        ) from None
