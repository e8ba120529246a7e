"""What identical webcams saw when they were last known, kept in the state directory: after a restart too they are told
apart by this. Private to its owner, as it is a small picture of the room.
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
from mocapd.set_aside import Why, set_aside
from mocapd.types import Camera
from mocapd.whole_file import whole_file

_log = logging.getLogger(__name__)

FILE_NAME = "rooms_of_twins.msgpack"
SCHEMA = 1
_MOST_BYTES = 4 << 20
_MOST_SIDE_PX = 4096
DIGEST_BYTES = 16


class _KeptView(msgspec.Struct, frozen=True):
    """picture: grey, row by row; places: x, y as little-endian 32-bit floats [px]."""

    width: Annotated[int, Meta(ge=1, le=_MOST_SIDE_PX)]
    height: Annotated[int, Meta(ge=1, le=_MOST_SIDE_PX)]
    picture: bytes
    places: bytes


class _KeptRoom(msgspec.Struct, frozen=True):
    """calibration: a digest of the lens and place that it was seen from."""

    camera: str
    calibration: bytes
    views: list[_KeptView]


class _Schema(msgspec.Struct, frozen=True):
    """What every version has."""

    schema: int


class _KeptRooms(msgspec.Struct, frozen=True):
    schema: Literal[1]
    rooms: list[_KeptRoom]


class RoomMemory:
    """One file. That it cannot be read or written is told once, and costs only this memory."""

    def __init__(self, state_dir: Path) -> None:
        self._path = state_dir / FILE_NAME
        self._failed = False

    def read(self, cameras: Mapping[str, Camera]) -> dict[str, list[Landmarks]]:
        """Of those cameras that are calibrated as they were then. A file that cannot be used is set aside."""
        try:
            return kept_rooms(self._path, cameras)
        except MissingError:
            return {}
        except (InputError, NewerFileError) as error:
            self._put_aside(error)
            return {}

    def _put_aside(self, error: MocapdError) -> None:
        where = ""
        with suppress(OSError):  # it is met again then
            why: Why = "newer" if isinstance(error, NewerFileError) else "corrupt"
            where = f", and is kept as {set_aside(self._path, why).name}"
        _log.warning(
            "%s cannot be used (%s)%s; it is made anew: until then identical cameras are told apart by their ports alone",
            *(self._path, error.what, where),
        )

    def write(self, cameras: Mapping[str, Camera], rooms: Mapping[str, list[Landmarks]]) -> None:
        """In place of what was there."""
        kept = [
            _KeptRoom(name, _mark(cameras[name]), [_kept(one) for one in views])
            for name, views in rooms.items()
        ]
        body = msgspec.msgpack.encode(_KeptRooms(1, kept))
        try:
            self._path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
            with whole_file(self._path, private=True) as partial:
                partial.write_bytes(digest_of(body) + body)
        except OSError as error:
            if not self._failed:
                _log.warning(
                    "what identical cameras see cannot be kept for the next start (%s): %s -- make room or the folder "
                    "writable",
                    *(error.strerror, self._path),
                )
            self._failed = True


def kept_rooms(path: Path, cameras: Mapping[str, Camera]) -> dict[str, list[Landmarks]]:
    """Of those cameras that are calibrated as they were then. Raises MissingError, InputError for a damaged one,
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
    kept = decode_msgpack(body, _KeptRooms)
    return {
        room.camera: [_view(one, cameras[room.camera]) for one in room.views]
        for room in kept.rooms
        if room.camera in cameras and room.calibration == _mark(cameras[room.camera])
    }


def _kept(view: Landmarks) -> _KeptView:
    height, width = view.picture.shape
    places = view.places.astype("<f4").tobytes()
    return _KeptView(width, height, view.picture.tobytes(), places)


def _view(kept: _KeptView, camera: Camera) -> Landmarks:
    """Raises InputError."""
    if len(kept.picture) != kept.width * kept.height or len(kept.places) % 8:
        raise InputError("has a picture of another size than it says")
    picture = np.frombuffer(kept.picture, np.uint8).reshape(kept.height, kept.width)
    places = np.frombuffer(kept.places, "<f4").astype(np.float32).reshape(-1, 2)
    if not (np.isfinite(places).all() and (np.abs(places) < _MOST_SIDE_PX).all()):
        raise InputError("has marks outside of its picture")
    return landmarks_at(picture, places, camera)


def _mark(camera: Camera) -> bytes:
    """Of a calibration: another one is of another place."""
    values = np.concatenate(
        [np.ravel(one) for one in (camera.size_px, camera.K, camera.dist, camera.R, camera.t_m)]
    )
    return digest_of(values.astype("<f8").tobytes())


def digest_of(data: bytes) -> bytes:
    """What the file begins with, of all that follows."""
    return hashlib.blake2b(data, digest_size=DIGEST_BYTES).digest()
