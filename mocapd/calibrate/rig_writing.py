"""The rig's file in the capture format, written whole or not at all."""

import json
import os
from pathlib import Path

from mocapd.errors import CannotCreateError
from mocapd.geometry.rig_file import camera_to_dict
from mocapd.types import Rig


def write_rig(path: Path, rig: Rig) -> None:
    """Write it beside its place, then move it there: what was there before stays until then.

    Raises CannotCreateError.
    """
    partial = path.with_name(f".{path.name}.{os.getpid()}")
    text = json.dumps({"cameras": [camera_to_dict(camera) for camera in rig.cameras]}, indent=1)
    try:
        with partial.open("w", encoding="utf-8") as file:
            file.write(text + "\n")
            file.flush()
            os.fsync(file.fileno())
        partial.replace(path)
    except OSError as error:
        raise CannotCreateError(
            f"cannot be written ({error.strerror})", str(path), "make room or choose another place"
        ) from None
    finally:
        partial.unlink(missing_ok=True)
