"""The pose database on disk: made once, then mapped into memory.

Layout: MAGIC, a checksum of all that follows (4 bytes), the length of the header (8 bytes, both
little-endian), a JSON header (version, content hash, and per array name, type, shape and offset), then
the arrays, each from a multiple of 64 bytes on. The write is atomic: a temporary file in the
same folder, fsync, rename.
"""

import json
import os
import tempfile
import zlib
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from mocapd.boundary.parsing import parse_json
from mocapd.errors import CannotCreateError, MalformedError
from mocapd.file_lock import one_at_a_time
from mocapd.shirt.pose_database.cache_name import BEGINNING_NAME, CACHE_NAME
from mocapd.shirt.pose_database.database import (
    VERSION,
    DatabaseParams,
    MapChunks,
    PoseDatabase,
    Progress,
    build_database,
    content_hash,
)
from mocapd.shirt.pose_database.idmap_index import IdMapIndex, Projection
from mocapd.whole_file import whole_file

LOCK_NAME = "pose_database.lock"
BEGINNING_LOCK_NAME = "pose_database-beginning.lock"
BEGINNING = DatabaseParams(count=4000)
_MAGIC = b"mocapd pose database 2\n"
_ALIGNMENT = 64
_CHECKSUM_BYTES = 4
_BLOCK = 1 << 20


class _UnusableError(Exception):
    """Why a file cannot be used; becomes the `reason` of LoadedDatabase."""


@dataclass(frozen=True, slots=True, eq=False)
class LoadedDatabase:
    """The database, and its origin: `built` because of `reason` ("" when read from the file).

    `warning` is a line for the user, or "": the cache could not be written, so the next start builds
    again.
    """

    database: PoseDatabase
    built: bool
    reason: str = ""
    warning: str = ""


def is_current(cache_dir: Path) -> bool:
    """True if the database's file can be used: neither missing nor damaged nor of another version."""
    try:
        _read(cache_dir / CACHE_NAME, content_hash(DatabaseParams()))
    except _UnusableError:
        return False
    return True


def load_or_build(
    cache_dir: Path,
    params: DatabaseParams | None = None,
    progress: Progress = lambda _: None,
    map_chunks: MapChunks = map,
    must_cache: bool = False,
) -> LoadedDatabase:
    """The database of `params` from `cache_dir`; built and written there when it is missing or stale.

    progress(0..1) is called while building only. Raises CannotCreateError when the cache cannot be
    written and `must_cache`; otherwise the database stays in memory and `warning` says so.
    """
    loaded = _load_or_build(
        cache_dir / CACHE_NAME,
        LOCK_NAME,
        params or DatabaseParams(),
        progress,
        map_chunks,
        must_cache,
    )
    if loaded.built and not loaded.warning:
        with suppress(OSError):  # a few megabytes stay
            (cache_dir / BEGINNING_NAME).unlink(missing_ok=True)
    return loaded


def load_or_build_beginning(
    cache_dir: Path, progress: Progress = lambda _: None, map_chunks: MapChunks = map
) -> LoadedDatabase:
    """The whole database if its file can be used; else a twentieth of its poses, which takes 1.5 s to build, and finds
    nearly as much: docs/decisions/pose-database.md."""
    with suppress(_UnusableError):
        whole = _read(cache_dir / CACHE_NAME, content_hash(DatabaseParams()))
        return LoadedDatabase(whole, built=False)
    return _load_or_build(
        cache_dir / BEGINNING_NAME, BEGINNING_LOCK_NAME, BEGINNING, progress, map_chunks
    )


def _load_or_build(
    path: Path,
    lock_name: str,
    params: DatabaseParams,
    progress: Progress,
    map_chunks: MapChunks,
    must_cache: bool = False,
) -> LoadedDatabase:
    cache_dir, wanted = path.parent, content_hash(params)
    try:
        return LoadedDatabase(_read(path, wanted), built=False)
    except _UnusableError:
        if must_cache:
            _check_writable(cache_dir)
    with one_at_a_time(cache_dir, lock_name):
        try:
            return LoadedDatabase(
                _read(path, wanted), built=False
            )  # by the process that held the lock
        except _UnusableError as error:
            reason = str(error)
        database = build_database(params, progress, map_chunks)
        try:
            write_database(path, database, wanted)
        except CannotCreateError as error:
            if must_cache:
                raise
            return LoadedDatabase(database, built=True, reason=reason, warning=str(error))
        # mapped pages can be given back to the system, the built arrays cannot
        return LoadedDatabase(_read(path, wanted), built=True, reason=reason)


def write_database(path: Path, database: PoseDatabase, digest: str) -> None:
    """Write the file as a whole or not at all. Raises CannotCreateError."""
    arrays = _arrays(database)
    entries: list[dict[str, Any]] = []
    offset = 0
    for name, array in arrays.items():
        offset += -offset % _ALIGNMENT
        entries.append(
            {"name": name, "dtype": array.dtype.str, "shape": array.shape, "offset": offset}
        )
        offset += array.nbytes
    header = json.dumps(
        {"version": VERSION, "content": digest, "size": offset, "arrays": entries}
    ).encode()
    head = len(header).to_bytes(8, "little") + header
    base = len(_MAGIC) + _CHECKSUM_BYTES + len(head)
    _check_writable(path.parent)
    try:
        with whole_file(path) as partial, partial.open("w+b") as file:
            file.write(_MAGIC + b"\0" * _CHECKSUM_BYTES + head)
            file.write(b"\0" * (-base % _ALIGNMENT))
            start = file.tell()
            for entry, array in zip(entries, arrays.values(), strict=True):
                file.write(b"\0" * (start + entry["offset"] - file.tell()))
                file.write(array.view(np.uint8).reshape(-1).data)
            checksum = _checksum(file)
            file.seek(len(_MAGIC))
            file.write(checksum)
    except OSError as error:
        raise _cannot_create(path.parent, error) from None


def _check_writable(folder: Path) -> None:
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise _cannot_create(folder, error) from None


def _cannot_create(folder: Path, error: OSError) -> CannotCreateError:
    return CannotCreateError(
        f"the pose database cannot be stored there ({error.strerror or error})",
        str(folder),
        "give the service a cache folder it may write to, with 150 MB free; without it every start"
        " builds the database again",
    )


def _read(path: Path, wanted: str) -> PoseDatabase:
    """The database of a file, mapped into memory. Raises _UnusableError saying why not."""
    try:
        with path.open("rb") as file:
            base, entries = _header(file, path, wanted)
        arrays: dict[str, NDArray[Any]] = {
            str(entry["name"]): np.memmap(
                path, np.dtype(entry["dtype"]), "r", base + entry["offset"], tuple(entry["shape"])
            )
            for entry in entries
        }
        return _database(arrays)
    except FileNotFoundError:
        raise _UnusableError(f"no pose database at {path} yet") from None
    except OSError as error:
        raise _UnusableError(f"{path} cannot be read ({error.strerror or error})") from None
    except (MalformedError, KeyError, TypeError, ValueError, OverflowError):
        raise _UnusableError(f"{path} is damaged (its header)") from None


def _header(file: IO[bytes], path: Path, wanted: str) -> tuple[int, list[dict[str, Any]]]:
    """Offset of the arrays, and their entries; verifies the checksum of the whole file."""
    magic = file.read(len(_MAGIC))
    if magic != _MAGIC:
        raise _UnusableError(f"{path} is no pose database of this version")
    expected = file.read(_CHECKSUM_BYTES)
    length = int.from_bytes(file.read(8), "little")
    if length > _BLOCK:
        raise _UnusableError(f"{path} is damaged (its header)")
    header = parse_json(file.read(length).decode())
    base = file.tell() + -file.tell() % _ALIGNMENT
    if header["version"] != VERSION or header["content"] != wanted:
        raise _UnusableError(f"{path} is of another version")
    if os.fstat(file.fileno()).st_size != base + header["size"]:
        raise _UnusableError(f"{path} is cut short")
    if _checksum(file) != expected:
        raise _UnusableError(f"{path} is damaged (its checksum)")
    entries: list[dict[str, Any]] = header["arrays"]
    return base, entries


def _checksum(file: IO[bytes]) -> bytes:
    """Of all behind it, read in blocks, so that the process' memory does not grow by the file."""
    checksum = 0
    file.seek(len(_MAGIC) + _CHECKSUM_BYTES)
    while block := file.read(_BLOCK):
        checksum = zlib.crc32(block, checksum)
    return checksum.to_bytes(_CHECKSUM_BYTES, "little")


def _arrays(database: PoseDatabase) -> dict[str, NDArray[Any]]:
    index = database.index
    arrays = {
        "local_xyzw": database.local_xyzw,
        "camera_from_root_xyzw": database.camera_from_root_xyzw,
        "root_m": database.root_m,
        "side_rad": database.side_rad,
        "mean": index.projection.mean,
        "basis": index.projection.basis,
        "centres": index.centres,
        "start": index.start,
        "vectors": index.vectors,
        "packed_maps": index.packed_maps,
    }
    return {name: np.ascontiguousarray(array) for name, array in arrays.items()}


def _database(arrays: dict[str, NDArray[Any]]) -> PoseDatabase:
    # plain views: numba would compile everything a second time for the memmap subclass
    plain = {name: np.asarray(array).view(np.ndarray) for name, array in arrays.items()}
    # every query reads these: copies in memory
    small = {name: plain[name].copy() for name in ("mean", "basis", "centres", "start")}
    return PoseDatabase(
        local_xyzw=plain["local_xyzw"],
        camera_from_root_xyzw=plain["camera_from_root_xyzw"],
        root_m=plain["root_m"],
        side_rad=plain["side_rad"],
        index=IdMapIndex(
            projection=Projection(small["mean"], small["basis"]),
            centres=small["centres"],
            start=small["start"],
            vectors=plain["vectors"],
            packed_maps=plain["packed_maps"],
        ),
    )
