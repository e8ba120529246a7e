"""Stores the last views of identified identical webcams in the state directory, to identify them after a restart.

The file is readable by its owner only, as it shows the room.
"""

import hashlib
import logging
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Annotated, Literal

import msgspec
import numpy as np
from msgspec import Meta

from mocapd.boundary.files import MissingError, read_file
from mocapd.boundary.numbers import brief
from mocapd.boundary.parsing import decode_msgpack
from mocapd.calibrate.bump.landmarks import Landmarks, landmarks_at
from mocapd.errors import InputError, MocapdError, NewerFileError
from mocapd.quarantine import Why, quarantine
from mocapd.types import Camera
from mocapd.whole_file import whole_file

_log = logging.getLogger(__name__)

FILE_NAME = "rooms_of_twins.msgpack"
SCHEMA = 1
_MOST_BYTES = 4 << 20
_MOST_SIDE_PX = 4096
DIGEST_BYTES = 16


class _StoredView(msgspec.Struct, frozen=True):
    """picture: grey, row by row; places: x, y as little-endian 32-bit floats [px]."""

    width: Annotated[int, Meta(ge=1, le=_MOST_SIDE_PX)]
    height: Annotated[int, Meta(ge=1, le=_MOST_SIDE_PX)]
    picture: bytes
    places: bytes


class _StoredRoom(msgspec.Struct, frozen=True):
    """calibration: digest of the intrinsics and extrinsics during the view."""

    camera: str
    calibration: bytes
    views: list[_StoredView]


class _Schema(msgspec.Struct, frozen=True):
    """The common part of all versions."""

    schema: int


class _StoredRooms(msgspec.Struct, frozen=True):
    schema: Literal[1]
    rooms: list[_StoredRoom]


class RoomMemory:
    """One file. An unreadable or unwritable file is logged once and costs only the memory."""

    def __init__(self, state_dir: Path) -> None:
        self._path = state_dir / FILE_NAME
        self._failed = False

    def read(self, cameras: Mapping[str, Camera]) -> dict[str, list[Landmarks]]:
        """The views of cameras with an unchanged calibration. Quarantines an unusable file."""
        try:
            return read_rooms(self._path, cameras)
        except MissingError:
            return {}
        except (InputError, NewerFileError) as error:
            self._quarantine(error)
            return {}

    def _quarantine(self, error: MocapdError) -> None:
        where = ""
        with suppress(OSError):  # the next start tries again
            why: Why = "newer" if isinstance(error, NewerFileError) else "corrupt"
            where = f", and is now {quarantine(self._path, why).name}"
        _log.warning(
            "%s cannot be used (%s)%s; until a new one is written only the USB ports distinguish identical cameras",
            *(self._path, error.what, where),
        )

    def write(self, cameras: Mapping[str, Camera], rooms: Mapping[str, list[Landmarks]]) -> None:
        """Replaces the file."""
        stored = [
            _StoredRoom(name, _calibration_digest(cameras[name]), [_encode(view) for view in views])
            for name, views in rooms.items()
        ]
        body = msgspec.msgpack.encode(_StoredRooms(1, stored))
        try:
            self._path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
            with whole_file(self._path, private=True) as partial:
                partial.write_bytes(digest_of(body) + body)
        except OSError as error:
            if not self._failed:
                _log.warning(
                    "the views of identical cameras cannot be saved for the next start (%s): %s -- make room or the folder "
                    "writable",
                    *(error.strerror, self._path),
                )
            self._failed = True


def read_rooms(path: Path, cameras: Mapping[str, Camera]) -> dict[str, list[Landmarks]]:
    """The views of cameras with an unchanged calibration. Raises MissingError, InputError for a damaged file,
    NewerFileError."""
    data = read_file(path, _MOST_BYTES)
    body = data[DIGEST_BYTES:]
    if digest_of(body) != data[:DIGEST_BYTES]:
        raise InputError("its checksum does not fit", str(path))
    schema = decode_msgpack(body, _Schema).schema
    if schema > SCHEMA:
        raise NewerFileError(
            f"has schema {brief(schema)}, this mocapd reads {SCHEMA}",
            *(str(path), "use the mocapd that wrote it"),
        )
    stored = decode_msgpack(body, _StoredRooms)
    return {
        room.camera: [_decode(view, cameras[room.camera]) for view in room.views]
        for room in stored.rooms
        if room.camera in cameras and room.calibration == _calibration_digest(cameras[room.camera])
    }


def _encode(view: Landmarks) -> _StoredView:
    height, width = view.picture.shape
    places = view.places.astype("<f4").tobytes()
    return _StoredView(width, height, view.picture.tobytes(), places)


def _decode(stored: _StoredView, camera: Camera) -> Landmarks:
    """Raises InputError."""
    if len(stored.picture) != stored.width * stored.height or len(stored.places) % 8:
        raise InputError("has a picture of another size than it says")
    picture = np.frombuffer(stored.picture, np.uint8).reshape(stored.height, stored.width)
    places = np.frombuffer(stored.places, "<f4").astype(np.float32).reshape(-1, 2)
    if not (np.isfinite(places).all() and (np.abs(places) < _MOST_SIDE_PX).all()):
        raise InputError("has marks outside of its picture")
    return landmarks_at(picture, places, camera)


def _calibration_digest(camera: Camera) -> bytes:
    values = np.concatenate(
        [np.ravel(value) for value in (camera.size_px, camera.K, camera.dist, camera.R, camera.t_m)]
    )
    return digest_of(values.astype("<f8").tobytes())


def digest_of(data: bytes) -> bytes:
    """The checksum at the file's beginning, of all that follows."""
    return hashlib.blake2b(data, digest_size=DIGEST_BYTES).digest()
